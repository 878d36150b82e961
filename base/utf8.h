/* Checks and cuts UTF-8 without any library. */
#ifndef GOPURA_BASE_UTF8_H
#define GOPURA_BASE_UTF8_H

#include <stddef.h>

/* Returns the number of bytes of the UTF-8 character at text, which ends with a zero; 0 if it is
 * invalid or a control character. */
size_t utf8_bytes(const char *text);
/* Cuts the text to at most that many bytes, without splitting a character. */
void utf8_cut(char *text, size_t bytes);

#endif
