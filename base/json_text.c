/* Parses JSON by cJSON, which keeps no positions, and finds lines by jsmn, which keeps little else.
 */
#include "base/json_text.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>
#include <glib.h>

/* With the index of its parent in each token, jsmn's time is linear. */
#define JSMN_STATIC
#define JSMN_PARENT_LINKS
#include <jsmn.h>

#include "base/json_tree.h"

#define BYTE_ORDER_MARK "\xef\xbb\xbf"

struct walk {
	struct json_text *out;
	const char *text; /* where the offsets of tokens count from */
	const char *at;   /* text up to here has been counted */
	unsigned line;    /* of at */
	const jsmntok_t *tokens;
	int next, token_count;
};

static unsigned line_of(const char *text, const char *at)
{
	unsigned line = 1;

	for (; text < at; text++)
		line += *text == '\n';
	return line;
}

/* Both parsers have the values in the order of the text; jsmn has the keys too, each before its
 * value. cJSON limits the depth (CJSON_NESTING_LIMIT). */
static int note_lines(struct walk *walk, const cJSON *value)
{
	const cJSON *child;
	int rc = 0;

	if (walk->next >= walk->token_count)
		return 0;
	for (const char *start = walk->text + walk->tokens[walk->next++].start; walk->at < start;
	     walk->at++)
		walk->line += *walk->at == '\n';
	if (cJSON_IsObject(value))
		rc = map_set(&walk->out->lines, (uintptr_t)value, walk->line);
	cJSON_ArrayForEach(child, value)
	{
		walk->next += cJSON_IsObject(value);
		if (rc == 0)
			rc = note_lines(walk, child);
	}
	return rc;
}

static int find_lines(struct json_text *out, const char *text)
{
	struct walk walk = { .out = out, .line = 1 };
	jsmntok_t *tokens;
	jsmn_parser parser;
	size_t size;
	int rc = 0;

	if (strncmp(text, BYTE_ORDER_MARK, strlen(BYTE_ORDER_MARK)) == 0)
		text += strlen(BYTE_ORDER_MARK);
	size = strlen(text);
	jsmn_init(&parser);
	walk.token_count = jsmn_parse(&parser, text, size, NULL, 0);
	if (walk.token_count <= 0)
		return 0;
	tokens = malloc((size_t)walk.token_count * sizeof(*tokens));
	if (!tokens)
		return -ENOMEM;
	jsmn_init(&parser);
	if (jsmn_parse(&parser, text, size, tokens, (unsigned)walk.token_count) > 0) {
		walk.tokens = tokens;
		walk.text = walk.at = text;
		rc = note_lines(&walk, out->root);
	}
	free(tokens);
	return rc;
}

int json_text_parse(struct json_text *out, struct buffer *buffer, const char *file,
		    struct diagnostics *diagnostics)
{
	const char *text, *end;
	int rc;

	*out = (struct json_text){ 0 };
	buffer_put_u8(buffer, 0);
	if (buffer->error)
		return buffer->error;
	text = (const char *)buffer->data;
	if (!text[strspn(text, " \t\r\n")])
		return diagnostics_add(diagnostics, -EBADMSG, file, 1,
				       "is empty, not JSON: copy or save it again");
	if (!g_utf8_validate(text, -1, &end)) /* cJSON does not check this */
		return diagnostics_add(diagnostics, -EBADMSG, file, line_of(text, end),
				       "is not UTF-8 from here on: save it as UTF-8");
	/* With the zero, or cJSON would give the last byte as the place of what is missing at the
	 * end. */
	rc = json_parse_to(&out->root, (struct bytes){ buffer->data, strlen(text) + 1 }, &end);
	while (rc == 0 && *end && (unsigned char)*end <= ' ')
		end++; /* as cJSON does between values */
	if (rc == -ENOMEM)
		return rc;
	if (rc < 0 || *end) {
		json_text_finish(out);
		return diagnostics_add(diagnostics, -EBADMSG, file, line_of(text, end),
				       "is not valid JSON from here on: look for a missing comma, "
				       "quote or bracket");
	}
	return find_lines(out, text);
}

void json_text_finish(struct json_text *json)
{
	cJSON_Delete(json->root);
	map_finish(&json->lines);
	*json = (struct json_text){ 0 };
}

unsigned json_text_line(const struct json_text *json, const cJSON *object)
{
	const uint64_t line = map_get(&json->lines, (uintptr_t)object);

	return line == MAP_NONE ? 0 : (unsigned)line;
}
