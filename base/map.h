/* Hash map from keys of up to 128 bits (numbers, and the names of objects) to numbers or pointers.
 * A plain value; zeroed is empty. One thread. */
#ifndef GOPURA_BASE_MAP_H
#define GOPURA_BASE_MAP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/compiler.h"

typedef unsigned __int128 map_key; /* of a number: itself; of an object: hash_key */

#define MAP_NONE UINT64_MAX /* cannot be stored as a value */

struct map {
	struct map_slot *slots; /* owned */
	size_t count, capacity; /* capacity: a power of two, or 0 */
};

void map_finish(struct map *map); /* frees the map and leaves it empty; NULL is fine */
void map_clear(struct map *map);  /* removes all entries and keeps the memory */
/* Returns the value of the key, or MAP_NONE where it is missing. */
uint64_t map_get(const struct map *map, map_key key);
/* Sets or replaces a value. Returns 0, or -ENOMEM: nothing changed. */
must_check int map_set(struct map *map, map_key key, uint64_t value);
/* Sets a value unless the key has one. Returns 1 if it was set, 0 if the key was there (its value
 * stays), or -ENOMEM. */
must_check int map_add(struct map *map, map_key key, uint64_t value);
void map_remove(struct map *map, map_key key); /* a missing key is fine */
/* Goes over all values, in no defined order: start with *at = 0. Returns MAP_NONE after the last.
 * The map must not change in between. */
uint64_t map_next(const struct map *map, size_t *at);
/* The same for keys: returns false after the last, and *key is then unchanged. */
bool map_next_key(const struct map *map, size_t *at, map_key *key);

/* For values that are pointers, stored by (uintptr_t); NULL where the key is missing. */
static inline void *map_get_pointer(const struct map *map, map_key key)
{
	const uint64_t value = map_get(map, key);

	return value == MAP_NONE ? NULL : (void *)(uintptr_t)value;
}

/* map_next for values that are pointers; NULL after the last. */
static inline void *map_next_pointer(const struct map *map, size_t *at)
{
	const uint64_t value = map_next(map, at);

	return value == MAP_NONE ? NULL : (void *)(uintptr_t)value;
}

#endif
