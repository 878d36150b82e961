/* Appends text to a buffer: plain, or escaped for HTML. Failures are kept in the buffer. */
#ifndef GOPURA_HEALTH_TEXT_H
#define GOPURA_HEALTH_TEXT_H

#include "base/bytes.h"

/* Appends text as it is. */
void text_put(struct buffer *out, const char *text);
/* Appends formatted text; more than 1023 bytes are cut. */
void text_format(struct buffer *out, const char *format, ...) printf_like(2, 3);
/* Appends text as the content of an element or a quoted attribute: &, <, > and quotes are escaped.
 * Control characters and non-ASCII bytes are passed, because the page is UTF-8. */
void text_put_html(struct buffer *out, const char *text);

#endif
