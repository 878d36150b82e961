/* Shared by export and import of annotations. Private to pipeline/content/annotations*.c. */
#ifndef GOPURA_PIPELINE_CONTENT_ANNOTATIONS_PRIVATE_H
#define GOPURA_PIPELINE_CONTENT_ANNOTATIONS_PRIVATE_H

#include <cjson/cJSON.h>

#include "pipeline/content/annotations.h"
#include "pipeline/content/draft_private.h"

enum { ANNOTATION_MEMBERS_MAX = 4 };

/* A kind of region and the selector that expresses it, with the same members. */
struct annotation_selector {
	const char *kind, *type;
	const char *members[ANNOTATION_MEMBERS_MAX]; /* ends at the first NULL */
};

enum { ANNOTATION_SELECTORS = 4 };
extern const struct annotation_selector annotation_selectors[ANNOTATION_SELECTORS];

/* The Dublin Core elements that parts.json supports, and the texts that a part has in each
 * language. */
enum { ANNOTATION_ELEMENTS = 9, ANNOTATION_TEXTS = 3 };
extern const char *const annotation_elements[ANNOTATION_ELEMENTS];
struct annotation_text {
	const char *key, *purpose;
};
extern const struct annotation_text annotation_texts[ANNOTATION_TEXTS];

/* Collects the languages of the parts' titles in order of appearance; the strings are borrowed from
 * json. Returns how many there are; at most INFO_LANGUAGES_MAX are written. */
uint32_t annotation_languages(const cJSON *json, const char *languages[INFO_LANGUAGES_MAX]);

/* ---- import */

struct page_file {
	char name[INFO_ID_BYTES_MAX + 40]; /* for example "pages/gate.en.html" */
	const char *html;                  /* borrowed from the file's JSON */
};

struct importer {
	const struct annotations_import_options *options;
	struct diagnostics *diagnostics; /* of the options */
	struct annotations_imported *report;
	const char *language;
	cJSON *parts_file, *parts; /* parts_file is owned; parts is the array in it */
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
};

/* Returns whether the folder has no parts.json, tours.json and pages yet; otherwise it says so.
 * Removes an empty pages/. */
bool importer_has_room(struct importer *im);
/* Writes what was read and checks it. On failure everything written is removed. Negative errno. */
must_check int importer_write(struct importer *im);

#endif
