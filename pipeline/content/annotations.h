/* The parts of a content folder as W3C Web Annotations (JSON-LD) with Dublin Core's terms, for
 * exchange with other tools, and back. docs/annotations.md has the format. The publisher's side. */
#ifndef GOPURA_PIPELINE_CONTENT_ANNOTATIONS_H
#define GOPURA_PIPELINE_CONTENT_ANNOTATIONS_H

#include "pipeline/content/info_build.h"

enum { ANNOTATIONS_BYTES_MAX = 256 << 20 }; /* of a file */

struct annotations_export_options {
	const char *folder;
	const char *const *languages; /* NULL: those of the titles, in the order they appear */
	uint32_t language_count;
	info_complaint *complaint; /* NULL: they are logged */
	void *complaint_data;
};

struct annotations {
	struct buffer json;
	uint32_t count;
	char **pictures; /* owned; names that must lie beside the file: "pictures/gate.jpg" */
	uint32_t picture_count;
};

/* The same folder gives the same bytes. *out is finished by the caller; zeroed on failure. -EINVAL:
 * the folder is at fault and every fault was complained about; -ENOENT: it has no parts.json. */
must_check int annotations_export(struct annotations *out,
				  const struct annotations_export_options *options);
void annotations_finish(struct annotations *annotations); /* NULL and zeroed are fine */

struct annotations_import_options {
	const char *file;     /* its pictures lie beside it, in pictures/ */
	const char *folder;   /* made where it is missing; must have no parts.json and pages yet */
	const char *language; /* of texts that do not say; NULL: "en" */
	bool y_is_up;         /* in PointSelectors, as IIIF has it; else z */
	bool skip_unknown;    /* leave out, with a warning, what has no selector of ours */
	info_complaint *complaint;
	void *complaint_data;
};

struct annotations_imported {
	uint32_t part_count, page_count, picture_count, skipped_count;
};

/* Writes parts.json, pages/ and pictures/ and checks them as info_build does; on failure nothing
 * is left there. -EINVAL: the file, or what came of it, is at fault, complained about. */
must_check int annotations_import(struct annotations_imported *out,
				  const struct annotations_import_options *options);

#endif
