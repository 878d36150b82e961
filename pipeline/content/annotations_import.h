/* Converts W3C Web Annotations, and the comments of IIIF manifests, to the parts of a content
 * folder. docs/annotations.md and docs/iiif.md have the formats. Used by the publisher. */
#ifndef GOPURA_PIPELINE_CONTENT_ANNOTATIONS_IMPORT_H
#define GOPURA_PIPELINE_CONTENT_ANNOTATIONS_IMPORT_H

#include "pipeline/content/annotations.h"

struct annotations_import_options {
	const char *file; /* its pictures are beside it, in pictures/ */
	/* created if missing; must not have parts.json, tours.json or pages yet */
	const char *folder;
	const char *language; /* of texts without a language; NULL: "en" */
	bool y_is_up;         /* y is up in PointSelectors; otherwise z; in a manifest always y */
	bool skip_unknown;    /* skip annotations without a selector we know, with a warning */
	struct diagnostics *diagnostics; /* gets every fault and every warning; borrowed */
};

struct annotations_imported {
	uint32_t part_count, page_count, picture_count, skipped_count;
};

/* Writes parts.json, tours.json, pages/ and pictures/, and checks them as info_build does. On
 * failure everything it wrote is removed. *out gets the counts. -EINVAL: the file or the result has
 * faults, which were added to the diagnostics. */
must_check int annotations_import(struct annotations_imported *out,
				  const struct annotations_import_options *options);

#endif
