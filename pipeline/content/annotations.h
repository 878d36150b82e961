/* Converts the parts of a content folder to W3C Web Annotations (JSON-LD) with Dublin Core terms,
 * for exchange with other tools, and back. docs/annotations.md has the format. Used by the
 * publisher. */
#ifndef GOPURA_PIPELINE_CONTENT_ANNOTATIONS_H
#define GOPURA_PIPELINE_CONTENT_ANNOTATIONS_H

#include "pipeline/content/info_build.h"

enum { ANNOTATIONS_BYTES_MAX = 256 << 20 }; /* size limit of a file */

struct annotations_export_options {
	/* content folder */
	const char *folder;
	/* NULL: the languages of the titles, in order of appearance */
	const char *const *languages;
	uint32_t language_count;
	struct diagnostics *diagnostics; /* gets every fault and every warning; borrowed */
};

struct annotations {
	/* the file's text */
	struct buffer json;
	/* number of annotations */
	uint32_t count;
	/* owned; files that must lie beside the JSON file, such as "pictures/gate.jpg" */
	char **pictures;
	uint32_t picture_count;
};

/* Converts the folder. The same folder gives the same bytes. The caller finishes *out; it is zeroed
 * on failure. -EINVAL: the folder has faults, which were added to the diagnostics. -ENOENT:
 * it has no parts.json. */
must_check int annotations_export(struct annotations *out,
				  const struct annotations_export_options *options);
/* Frees the contents. NULL and zeroed are fine. */
void annotations_finish(struct annotations *annotations);

struct annotations_import_options {
	const char *file; /* its pictures are beside it, in pictures/ */
	/* created if missing; must not have parts.json, tours.json or pages yet */
	const char *folder;
	const char *language; /* of texts without a language; NULL: "en" */
	bool y_is_up;         /* y is up in PointSelectors, as in IIIF; otherwise z */
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
