/* Addresses that stand for names of files. */
#ifndef GOPURA_BASE_URI_H
#define GOPURA_BASE_URI_H

#include <stdbool.h>
#include <stddef.h>

/* Decodes %20 and the like; out has room bytes, at least one, and ends with a zero. A % that begins
 * no byte stands for itself, as does %00, which would end the name. Returns false if there is too
 * little room; then out has the beginning. */
bool uri_decode(char *out, size_t room, const char *uri);

#endif
