/* Hash map from 64-bit keys to 32-bit values; open addressing. A value; zeroed is empty. */
#ifndef GOPURA_RENDER_PLAN_CELL_MAP_H
#define GOPURA_RENDER_PLAN_CELL_MAP_H

#include <stdint.h>

#include "base/compiler.h"

#define MAP_NONE UINT32_MAX /* not a value */

struct map {
	uint64_t *keys;   /* owned */
	uint32_t *values; /* owned; MAP_NONE: free */
	uint32_t count, capacity;
};

void map_finish(struct map *map);
void map_clear(struct map *map); /* keeps the memory */
/* MAP_NONE where the key is not there. */
uint32_t map_get(const struct map *map, uint64_t key);
/* Sets or replaces. -ENOMEM: nothing changed. */
must_check int map_set(struct map *map, uint64_t key, uint32_t value);
/* A key that is not there is fine. */
void map_remove(struct map *map, uint64_t key);

#endif
