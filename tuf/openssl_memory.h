/* Whether OpenSSL failed for a lack of memory, which says nothing about a key or a signature. */
#ifndef GOPURA_TUF_OPENSSL_MEMORY_H
#define GOPURA_TUF_OPENSSL_MEMORY_H

#include <stdbool.h>

/* Returns whether a lack of memory is among the errors that OpenSSL has noted, and clears them.
 * OpenSSL does not note each: what fails is tried once more by who must be sure. A lack that is
 * over by then does not fail again; one that lasts fails the first allocation, which is noted or
 * returns NULL. */
bool openssl_lacked_memory(void);

#endif
