/* A map in memory from object names to numbers, with open addressing: names are hashes already.
 * Entries are never removed. */
#ifndef GOPURA_PIPELINE_RELEASE_OBJECT_MAP_H
#define GOPURA_PIPELINE_RELEASE_OBJECT_MAP_H

#include "format/hash.h"

struct hash_map_entry {
	struct hash hash;
	uint64_t value;
	bool used;
};

/* A zeroed struct is an empty map. End it with hash_map_finish. */
struct hash_map {
	struct hash_map_entry *entries; /* owned */
	size_t capacity;                /* a power of two, or 0 */
	size_t count;
};

/* Adds an entry. Returns 1 if it was added, 0 if the hash was there already (its value stays), or
 * -ENOMEM. */
must_check int hash_map_put(struct hash_map *map, struct hash hash, uint64_t value);
/* Returns false if the hash is not in the map; *value (may be NULL) is then unchanged. */
bool hash_map_get(const struct hash_map *map, struct hash hash, uint64_t *value);
void hash_map_finish(struct hash_map *map); /* NULL is fine */

#endif
