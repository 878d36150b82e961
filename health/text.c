/* Appends plain, formatted and HTML-escaped text to a buffer. */
#include "health/text.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void text_put(struct buffer *out, const char *text)
{
	buffer_put(out, text, strlen(text));
}

void text_format(struct buffer *out, const char *format, ...)
{
	char text[1024];
	va_list args;

	va_start(args, format);
	vsnprintf(text, sizeof(text), format, args);
	va_end(args);
	text_put(out, text);
}

void text_put_html(struct buffer *out, const char *text)
{
	while (*text) {
		const size_t plain = strcspn(text, "&<>\"'");

		buffer_put(out, text, plain);
		text += plain;
		if (*text)
			text_format(out, "&#%d;", *text++);
	}
}
