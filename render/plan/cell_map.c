/* Open addressing with linear probing, at most half full, and backward shifts on removal. */
#include "render/plan/cell_map.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* The finaliser of MurmurHash3, which spreads neighbouring keys. */
static uint32_t place_of(const struct map *map, uint64_t key)
{
	key ^= key >> 33;
	key *= 0xff51afd7ed558ccdu;
	key ^= key >> 33;
	key *= 0xc4ceb9fe1a85ec53u;
	key ^= key >> 33;
	return (uint32_t)key & (map->capacity - 1);
}

void map_finish(struct map *map)
{
	free(map->keys);
	free(map->values);
	memset(map, 0, sizeof(*map));
}

void map_clear(struct map *map)
{
	if (map->values)
		memset(map->values, 0xff, map->capacity * sizeof(*map->values));
	map->count = 0;
}

uint32_t map_get(const struct map *map, uint64_t key)
{
	if (map->count == 0)
		return MAP_NONE;
	for (uint32_t at = place_of(map, key);; at = (at + 1) & (map->capacity - 1)) {
		if (map->values[at] == MAP_NONE)
			return MAP_NONE;
		if (map->keys[at] == key)
			return map->values[at];
	}
}

static void put(struct map *map, uint64_t key, uint32_t value)
{
	uint32_t at = place_of(map, key);
	while (map->values[at] != MAP_NONE && map->keys[at] != key)
		at = (at + 1) & (map->capacity - 1);
	if (map->values[at] == MAP_NONE)
		map->count++;
	map->keys[at] = key;
	map->values[at] = value;
}

static int enlarge(struct map *map)
{
	struct map larger = { .capacity = map->capacity ? 2 * map->capacity : 64 };
	larger.keys = malloc(larger.capacity * sizeof(*larger.keys));
	larger.values = malloc(larger.capacity * sizeof(*larger.values));
	if (!larger.keys || !larger.values) {
		map_finish(&larger);
		return -ENOMEM;
	}
	map_clear(&larger);
	for (uint32_t i = 0; i < map->capacity; i++)
		if (map->values[i] != MAP_NONE)
			put(&larger, map->keys[i], map->values[i]);
	map_finish(map);
	*map = larger;
	return 0;
}

int map_set(struct map *map, uint64_t key, uint32_t value)
{
	if (2 * (map->count + 1) > map->capacity) {
		int rc = enlarge(map);
		if (rc < 0)
			return rc;
	}
	put(map, key, value);
	return 0;
}

void map_remove(struct map *map, uint64_t key)
{
	if (map_get(map, key) == MAP_NONE)
		return;
	uint32_t mask = map->capacity - 1, hole = place_of(map, key);
	while (map->keys[hole] != key)
		hole = (hole + 1) & mask;
	/* Entries that were probed past the hole move back into it. */
	for (uint32_t at = (hole + 1) & mask; map->values[at] != MAP_NONE; at = (at + 1) & mask) {
		uint32_t home = place_of(map, map->keys[at]);
		if (((at - home) & mask) < ((at - hole) & mask))
			continue;
		map->keys[hole] = map->keys[at];
		map->values[hole] = map->values[at];
		hole = at;
	}
	map->values[hole] = MAP_NONE;
	map->count--;
}
