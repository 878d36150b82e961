/* Positions in a JSON text, which cJSON does not keep. Private to pipeline/content. */
#ifndef GOPURA_PIPELINE_CONTENT_JSON_LINES_H
#define GOPURA_PIPELINE_CONTENT_JSON_LINES_H

#include <stddef.h>

/* Returns the line of a position in the text, from 1. */
unsigned json_line_of(const char *text, const char *at);

/* Returns the first position that is not UTF-8 (cJSON does not check this); NULL: all is valid. */
const char *json_not_utf8(const char *text);

/* Finds the lines on which the objects of the first array with that key begin, at any depth. The
 * text must be valid JSON. Writes at most `most` lines. */
void json_item_lines(const char *text, const char *key, unsigned *lines, size_t most);

#endif
