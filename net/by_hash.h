/* Entries found by hash. The map holds pointers to structs whose first member is the key; it owns
 * the array of pointers, not the entries. */
#ifndef GOPURA_NET_BY_HASH_H
#define GOPURA_NET_BY_HASH_H

#include "format/hash.h"

struct hash_entry {
	struct hash key;
};

struct by_hash {
	struct hash_entry **slots; /* owned; NULL: free */
	size_t capacity;           /* a power of two, or 0 */
	size_t count;
};

/* A zeroed map is empty. */
void by_hash_finish(struct by_hash *map);
/* NULL: not there. */
void *by_hash_find(const struct by_hash *map, struct hash key);
/* The key must not be there yet. entry is borrowed until it is removed. -ENOMEM. */
must_check int by_hash_add(struct by_hash *map, struct hash_entry *entry);
/* Not there: nothing happens. */
void by_hash_remove(struct by_hash *map, struct hash key);
/* Each entry in turn, in no order: begin with *at = 0; NULL after the last. The map must not change
 * meanwhile. */
void *by_hash_next(const struct by_hash *map, size_t *at);

#endif
