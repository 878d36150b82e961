/* The name of an object is the BLAKE2b hash of its bytes, 16 bytes long.
 *
 * Why 128 bits: a page of index entries consists mostly of hashes, and hashes do not compress. An
 * attacker who controls a mirror needs a second preimage (2^128 steps). A collision (2^64 steps)
 * only helps someone who makes both objects; that is the publisher, who signs anyway.
 * docs/release.md has the figures. */
#ifndef GOPURA_FORMAT_HASH_H
#define GOPURA_FORMAT_HASH_H

#include <stdbool.h>

#include "base/bytes.h"
#include "base/map.h"

enum { HASH_BYTES = 16, HASH_HEX_BYTES = 2 * HASH_BYTES + 1 /* with the final zero */ };

struct hash {
	uint8_t bytes[HASH_BYTES];
};

/* Returns the name of an object: the 128-bit BLAKE2b of all its bytes. Any thread. */
struct hash hash_of(struct bytes object);
map_key hash_key(struct hash hash);     /* the whole name as the key of a map */
struct hash hash_from_key(map_key key); /* the name again */
/* Comparisons of names. */
bool hash_equal(struct hash a, struct hash b);
int hash_compare(struct hash a, struct hash b); /* orders as memcmp */
bool hash_is_zero(struct hash hash);            /* zero means "none": no object has this name */
/* Writes 32 lower-case digits and a zero. */
void hash_to_hex(struct hash hash, char hex[HASH_HEX_BYTES]);
/* Returns -EBADMSG unless hex is exactly 32 lower-case hexadecimal digits. */
must_check int hash_from_hex(struct hash *out, const char *hex);

#endif
