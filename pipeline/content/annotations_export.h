/* Converts the parts of a content folder to W3C Web Annotations. docs/annotations.md has the
 * format. Or to a IIIF manifest, docs/iiif.md. Used by the publisher. */
#ifndef GOPURA_PIPELINE_CONTENT_ANNOTATIONS_EXPORT_H
#define GOPURA_PIPELINE_CONTENT_ANNOTATIONS_EXPORT_H

#include "pipeline/content/annotations.h"

struct annotations_export_options {
	/* content folder */
	const char *folder;
	/* NULL: the languages of the titles, in order of appearance */
	const char *const *languages;
	uint32_t language_count;
	/* NULL: an annotation collection. Otherwise a IIIF manifest of the scans and the parts, and
	 * the address where it will be published */
	const char *manifest_base;
	/* of a manifest: the file beside it that is shown in place of the scans, as gopura-content
	 * export makes it; NULL: the scans */
	const char *manifest_model;
	struct diagnostics *diagnostics; /* gets every fault and every warning; borrowed */
};

/* Converts the folder. The same folder gives the same bytes. The caller finishes *out; it is zeroed
 * on failure. -EINVAL: the folder has faults, which were added to the diagnostics. -ENOENT:
 * it has no parts.json. */
must_check int annotations_export(struct annotations *out,
				  const struct annotations_export_options *options);

#endif
