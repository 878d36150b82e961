/* The name of an object: BLAKE2b of its bytes, 16 bytes long.
 *
 * 128 bits because a page of index entries is mostly hashes, which do not compress, and because
 * what an attacker at a mirror needs is a second preimage (2^128); a collision (2^64) helps only
 * who makes both objects, and that is the publisher, who signs. docs/release.md has the figures. */
#ifndef GOPURA_FORMAT_HASH_H
#define GOPURA_FORMAT_HASH_H

#include <stdbool.h>

#include "base/bytes.h"

enum { HASH_BYTES = 16, HASH_HEX_BYTES = 2 * HASH_BYTES + 1 /* with its zero */ };

struct hash {
	uint8_t bytes[HASH_BYTES];
};

/* BLAKE2b of 128 bits, of all the bytes: the object's name. */
struct hash hash_of(struct bytes object);
bool hash_equal(struct hash a, struct hash b);
int hash_compare(struct hash a, struct hash b); /* as memcmp */
bool hash_is_zero(struct hash hash);            /* "none": no object has this name */
void hash_to_hex(struct hash hash, char hex[HASH_HEX_BYTES]);
/* -EBADMSG unless hex is exactly 32 lower-case hexadecimal digits. */
must_check int hash_from_hex(struct hash *out, const char *hex);

#endif
