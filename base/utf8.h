/* Checks and cuts UTF-8 without any library, for programs that do not link GLib. */
#ifndef GOPURA_BASE_UTF8_H
#define GOPURA_BASE_UTF8_H

#include <stddef.h>
#include <stdint.h>

/* Returns the number of bytes of the UTF-8 character at text, of which at most `left` are read; 0
 * if it is invalid, a control character, or there is none. A text that ends with a zero needs no
 * limit: SIZE_MAX. */
size_t utf8_bytes(const char *text, size_t left);
/* Cuts the text to at most that many bytes, without splitting a character. */
void utf8_cut(char *text, size_t bytes);
/* Replaces every byte that belongs to no character of UTF-8, or to a control character, by '?'. */
void utf8_make_printable(char *text);

#endif
