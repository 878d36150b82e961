/* Hash map from 64-bit keys to 32-bit values, by open addressing. A plain value; zeroed is
 * empty. */
#ifndef GOPURA_RENDER_PLAN_CELL_MAP_H
#define GOPURA_RENDER_PLAN_CELL_MAP_H

#include <stdint.h>

#include "base/compiler.h"

#define MAP_NONE UINT32_MAX /* cannot be stored as a value */

struct map {
	uint64_t *keys;   /* owned */
	uint32_t *values; /* owned; MAP_NONE: free slot */
	uint32_t count, capacity;
};

/* Frees the map and leaves it empty. */
void map_finish(struct map *map);
void map_clear(struct map *map); /* Removes all entries and keeps the memory. */
/* Returns the value of the key, or MAP_NONE where it is missing. */
uint32_t map_get(const struct map *map, uint64_t key);
/* Sets or replaces a value. -ENOMEM: nothing changed. */
must_check int map_set(struct map *map, uint64_t key, uint32_t value);
/* Removes a key; a missing key is fine. */
void map_remove(struct map *map, uint64_t key);

#endif
