/* Finds pictures of pages that have no alternative text: whoever cannot see them learns nothing.
 * gopura-content takes them all the same, so this is advice. */
#ifndef GOPURA_CURATOR_PUBLISH_ALT_TEXTS_H
#define GOPURA_CURATOR_PUBLISH_ALT_TEXTS_H

#include "base/bytes.h"

struct cJSON;

enum { ALT_TEXTS_MAX = 1000 }; /* that are listed */

/* Appends {"file", "line", "picture"} to a list for each picture of DIR/pages without one. A file
 * that cannot be read is left out: gopura-content names it. */
void alt_texts_find(struct cJSON *list, const char *folder);
/* The same for one page's HTML. */
void alt_texts_of(struct cJSON *list, const char *file, struct bytes html);

#endif
