/* From the name of an object to a number, in memory. Open addressing: names are hashes already.
 * Nothing is ever removed. */
#ifndef GOPURA_PIPELINE_RELEASE_OBJECT_MAP_H
#define GOPURA_PIPELINE_RELEASE_OBJECT_MAP_H

#include "format/hash.h"

struct hash_map_entry {
	struct hash hash;
	uint64_t value;
	bool used;
};

/* Zeroed is an empty map. Owned by whoever holds it. */
struct hash_map {
	struct hash_map_entry *entries; /* owned */
	size_t capacity;                /* a power of two, or 0 */
	size_t count;
};

/* 1: put. 0: it was there; its value stays. -ENOMEM. */
must_check int hash_map_put(struct hash_map *map, struct hash hash, uint64_t value);
/* false: not there, and *value (may be NULL) stays as it was. */
bool hash_map_get(const struct hash_map *map, struct hash hash, uint64_t *value);
void hash_map_finish(struct hash_map *map); /* NULL is fine */

#endif
