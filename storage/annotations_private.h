/* Private to storage: what export and import of annotations agree on. */
#ifndef GOPURA_STORAGE_ANNOTATIONS_PRIVATE_H
#define GOPURA_STORAGE_ANNOTATIONS_PRIVATE_H

#include <cjson/cJSON.h>

#include "storage/info_content.h"

enum { ANNOTATION_MEMBERS_MOST = 4 };

/* A region's kind and the selector that says the same, member by member. */
struct annotation_selector {
	const char *kind, *type;
	const char *members[ANNOTATION_MEMBERS_MOST]; /* up to the first NULL */
};

enum { ANNOTATION_SELECTORS = 3 };
extern const struct annotation_selector annotation_selectors[ANNOTATION_SELECTORS];

/* Dublin Core's terms that parts.json knows, and the texts that a part has in each language. */
enum { ANNOTATION_ELEMENTS = 9, ANNOTATION_TEXTS = 3 };
extern const char *const annotation_elements[ANNOTATION_ELEMENTS];
struct annotation_text {
	const char *key, *purpose;
};
extern const struct annotation_text annotation_texts[ANNOTATION_TEXTS];

/* The languages of the parts' titles, in the order in which they appear; borrowed from json. How
 * many there are; at most INFO_LANGUAGES_MOST are written. */
uint32_t annotation_languages(const cJSON *json, const char *languages[INFO_LANGUAGES_MOST]);

/* PATH_MAX bytes of a path: the folder of a file, or ".". */
void annotation_folder_of(const char *file, char *folder);

#endif
