/* Writes imported annotations into a content folder. Private to pipeline/content/annotations*.c. */
#ifndef GOPURA_PIPELINE_CONTENT_ANNOTATIONS_WRITE_H
#define GOPURA_PIPELINE_CONTENT_ANNOTATIONS_WRITE_H

#include "pipeline/content/annotations_import.h"
#include "pipeline/content/annotations_private.h"
#include "pipeline/content/draft.h"

struct page_file {
	char name[DRAFT_PAGE_NAME_BYTES]; /* for example "pages/gate.en.html" */
	const char *html;                 /* borrowed from the file's JSON */
	const char *item_id;              /* of its annotation, for messages; borrowed likewise */
	unsigned line;                    /* likewise */
	uint32_t position;                /* in the file, among the pages */
	bool is_document;                 /* came as one; also another part's page may be one */
};

struct importer {
	const struct annotations_import_options *options;
	struct diagnostics *diagnostics; /* of the options */
	struct annotations_imported *report;
	const char *language;
	bool y_is_up;              /* in PointSelectors */
	bool makes_ids;            /* equal ids get a number; otherwise they are refused */
	cJSON *parts_file, *parts; /* parts_file is owned; parts is the array in it */
	cJSON *comments;           /* owned; of a manifest; NULL: the file holds annotations */
	const cJSON *tours;        /* borrowed from the file's JSON; NULL: none */
	struct page_file *pages;   /* owned */
	uint32_t page_count, page_room;
	char **written; /* owned paths, in the order in which they were written */
	uint32_t written_count, written_room;
	bool failed; /* out of memory */
	/* The annotation that is being read. */
	const cJSON *item;
	unsigned line;
	cJSON *part;
	bool has_page; /* of its own */
};

/* Returns whether the folder has no parts.json, tours.json and pages yet; otherwise it says so.
 * Removes an empty pages/. */
bool importer_has_room(struct importer *im);
/* Writes what was read and checks it. On failure everything written is removed. Negative errno. */
must_check int importer_write(struct importer *im);

#endif
