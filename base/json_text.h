/* JSON that people wrote: cJSON's tree of a text, and the line of each object in it. */
#ifndef GOPURA_BASE_JSON_TEXT_H
#define GOPURA_BASE_JSON_TEXT_H

#include "base/bytes.h"
#include "base/diagnostics.h"
#include "base/map.h"

struct cJSON;

struct json_text {
	struct cJSON *root; /* owned */
	struct map lines;   /* from the address of each object in root to its line */
};

/* Parses what the buffer holds, after a zero that is added to it. *out is for json_text_finish,
 * also on failure. -EBADMSG: it is not UTF-8 or not JSON; diagnostics names file and the line from
 * which on. -EFBIG: the buffer has no room for the zero. -ENOMEM. */
must_check int json_text_parse(struct json_text *out, struct buffer *text, const char *file,
			       struct diagnostics *diagnostics);
/* Frees everything. Zeroed is fine. */
void json_text_finish(struct json_text *json);

/* Returns the line on which an object begins, from 1. 0: the value is no object, or the text has
 * control characters between values, which cJSON takes for white space and jsmn does not. */
unsigned json_text_line(const struct json_text *json, const struct cJSON *object);

#endif
