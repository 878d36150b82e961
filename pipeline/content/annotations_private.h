/* Private to storage: what export and import of annotations agree on. */
#ifndef GOPURA_PIPELINE_CONTENT_ANNOTATIONS_PRIVATE_H
#define GOPURA_PIPELINE_CONTENT_ANNOTATIONS_PRIVATE_H

#include <cjson/cJSON.h>

#include "pipeline/content/annotations.h"
#include "pipeline/content/info_content.h"

enum { ANNOTATION_MEMBERS_MAX = 4 };

/* A region's kind and the selector that says the same, member by member. */
struct annotation_selector {
	const char *kind, *type;
	const char *members[ANNOTATION_MEMBERS_MAX]; /* up to the first NULL */
};

enum { ANNOTATION_SELECTORS = 4 };
extern const struct annotation_selector annotation_selectors[ANNOTATION_SELECTORS];

/* Dublin Core's terms that parts.json knows, and the texts that a part has in each language. */
enum { ANNOTATION_ELEMENTS = 9, ANNOTATION_TEXTS = 3 };
extern const char *const annotation_elements[ANNOTATION_ELEMENTS];
struct annotation_text {
	const char *key, *purpose;
};
extern const struct annotation_text annotation_texts[ANNOTATION_TEXTS];

/* The languages of the parts' titles, in the order in which they appear; borrowed from json. How
 * many there are; at most INFO_LANGUAGES_MAX are written. */
uint32_t annotation_languages(const cJSON *json, const char *languages[INFO_LANGUAGES_MAX]);

/* ---- import */

struct page_file {
	char name[INFO_ID_BYTES_MAX + 40]; /* "pages/gate.en.html" */
	const char *html;                  /* borrowed from the file's JSON */
};

struct importer {
	const struct annotations_import_options *options;
	struct annotations_imported *report;
	const char *language;
	cJSON *parts_file, *parts; /* parts_file owned; parts is its array */
	const cJSON *tours;        /* borrowed from the file's JSON; NULL: none */
	struct page_file *pages;   /* owned */
	uint32_t page_count, error_count;
	char **written; /* owned paths, in the order of writing */
	size_t written_count;
	bool failed; /* memory ran out */
	/* The annotation that is read. */
	const cJSON *item;
	unsigned line;
	cJSON *part;
};

/* Of options->file. */
printf_like(4, 5) void importer_complain(struct importer *im, bool is_error, unsigned line,
					 const char *text, ...);
/* The folder has no parts and pages yet; else it was complained about. */
bool importer_has_room(struct importer *im);
/* Writes what was read, checks it, and takes it away again where that fails. */
must_check int importer_write(struct importer *im);

#endif
