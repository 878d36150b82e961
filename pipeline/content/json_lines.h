/* Private to storage: where in a JSON text things stand; cJSON keeps no positions. */
#ifndef GOPURA_PIPELINE_CONTENT_JSON_LINES_H
#define GOPURA_PIPELINE_CONTENT_JSON_LINES_H

#include <stddef.h>

/* The line of a place of the text, from 1. */
unsigned json_line_of(const char *text, const char *at);

/* The first place that is not UTF-8, which cJSON does not look at; NULL: all is. */
const char *json_not_utf8(const char *text);

/* Lines on which the objects of the array of that key begin, wherever it is; for a text that is
 * JSON. Writes at most `most`. */
void json_item_lines(const char *text, const char *key, unsigned *lines, size_t most);

#endif
