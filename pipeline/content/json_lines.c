/* Scans JSON text for line numbers, because cJSON keeps no positions. */
#include "pipeline/content/json_lines.h"

#include <glib.h>
#include <stdbool.h>
#include <string.h>

unsigned json_line_of(const char *text, const char *at)
{
	unsigned line = 1;

	for (; text < at && *text; text++)
		line += *text == '\n';
	return line;
}

const char *json_not_utf8(const char *text)
{
	const char *end;

	return g_utf8_validate(text, -1, &end) ? NULL : end;
}

/* Returns the closing quote of the string that begins at `quote`, or the end of the text. */
static const char *skip_string(const char *quote)
{
	const char *p = quote + 1;

	while (*p && *p != '"')
		p += *p == '\\' && p[1] ? 2 : 1;
	return p;
}

void json_item_lines(const char *text, const char *key, unsigned *lines, size_t most)
{
	const size_t size = strlen(key);
	unsigned line = 1, depth = 0,
		 inside = 0;  /* inside: depth of the array's items; 0: not in the array yet */
	bool is_next = false; /* the previous string was the key */
	size_t found = 0;

	for (const char *p = text; *p && found < most; p++) {
		line += *p == '\n';
		if (*p == '"') {
			const char *end = skip_string(p);

			is_next = (size_t)(end - p) == size + 1 && strncmp(p + 1, key, size) == 0;
			p = *end ? end : end - 1;
		} else if (*p == '{' || *p == '[') {
			if (*p == '{' && inside && depth == inside)
				lines[found++] = line;
			depth++;
			if (*p == '[' && is_next && !inside)
				inside = depth;
			is_next = false;
		} else if ((*p == '}' || *p == ']') && depth > 0) {
			if (depth-- == inside)
				return;
		}
	}
}
