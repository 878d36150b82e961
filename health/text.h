/* Text appended to a buffer: plain, or escaped for HTML. */
#ifndef GOPURA_HEALTH_TEXT_H
#define GOPURA_HEALTH_TEXT_H

#include "base/bytes.h"

void text_put(struct buffer *out, const char *text);
/* At most 1 KiB a call. */
void text_format(struct buffer *out, const char *format, ...) printf_like(2, 3);
/* As the content of an element or a quoted attribute; controls and bytes that are no ASCII pass,
 * for the page is UTF-8. */
void text_put_html(struct buffer *out, const char *text);

#endif
