/* Shared by export and import of annotations. Private to pipeline/content/annotations*.c. */
#ifndef GOPURA_PIPELINE_CONTENT_ANNOTATIONS_PRIVATE_H
#define GOPURA_PIPELINE_CONTENT_ANNOTATIONS_PRIVATE_H

#include <cjson/cJSON.h>

#include "pipeline/content/annotations.h"
#include "pipeline/content/draft.h"

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

#endif
