/* A map from hash to entry. It holds pointers to structs whose first member is the key. The map
 * owns the array of pointers; the caller owns the entries. */
#ifndef GOPURA_NET_BY_HASH_H
#define GOPURA_NET_BY_HASH_H

#include "format/hash.h"

struct hash_entry {
	struct hash key;
};

struct by_hash {
	struct hash_entry **slots; /* owned; NULL marks a free slot */
	size_t capacity;           /* a power of two, or 0 */
	size_t count;
};

/* Frees the array of pointers, not the entries. The map is empty afterwards. A zeroed map is a
 * valid empty map. */
void by_hash_finish(struct by_hash *map);
/* Returns the entry, borrowed, or NULL if the key is not in the map. */
void *by_hash_find(const struct by_hash *map, struct hash key);
/* The key must not be in the map yet. The entry is borrowed until it is removed. Returns 0 or
 * -ENOMEM. */
must_check int by_hash_add(struct by_hash *map, struct hash_entry *entry);
/* Does nothing if the key is not in the map. */
void by_hash_remove(struct by_hash *map, struct hash key);
/* Iterates over all entries, in no defined order. Start with *at = 0; returns NULL after the last
 * entry. The map must not change during the iteration. */
void *by_hash_next(const struct by_hash *map, size_t *at);

#endif
