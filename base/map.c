/* Open addressing with linear probing, at most half full, and backward shifts on removal. */
#include "base/map.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* The key in halves: a whole one would need 8 bytes of padding. */
struct map_slot {
	uint64_t low, high;
	uint64_t value; /* MAP_NONE: free slot */
};

enum { FIRST_CAPACITY = 64 };

static bool holds(const struct map_slot *slot, map_key key)
{
	return slot->low == (uint64_t)key && slot->high == (uint64_t)(key >> 64);
}

/* The finaliser of MurmurHash3, which spreads neighbouring keys. The factor (2^64 divided by the
 * golden ratio) keeps halves that are alike from cancelling each other. */
static size_t home_of(const struct map *map, uint64_t low, uint64_t high)
{
	uint64_t bits = low ^ high * 0x9e3779b97f4a7c15u;

	bits ^= bits >> 33;
	bits *= 0xff51afd7ed558ccdu;
	bits ^= bits >> 33;
	bits *= 0xc4ceb9fe1a85ec53u;
	bits ^= bits >> 33;
	return (size_t)bits & (map->capacity - 1);
}

/* Returns the slot that holds the key, or the free slot where it would be inserted. The map has
 * slots. */
static struct map_slot *slot_of(const struct map *map, map_key key)
{
	size_t at = home_of(map, (uint64_t)key, (uint64_t)(key >> 64));

	while (map->slots[at].value != MAP_NONE && !holds(&map->slots[at], key))
		at = (at + 1) & (map->capacity - 1);
	return &map->slots[at];
}

void map_finish(struct map *map)
{
	if (!map)
		return;
	free(map->slots);
	*map = (struct map){ 0 };
}

void map_clear(struct map *map)
{
	if (map->slots)
		memset(map->slots, 0xff, map->capacity * sizeof(*map->slots));
	map->count = 0;
}

uint64_t map_get(const struct map *map, map_key key)
{
	return map->count > 0 ? slot_of(map, key)->value : MAP_NONE;
}

static int enlarge(struct map *map)
{
	struct map larger = { .capacity = map->capacity ? 2 * map->capacity : FIRST_CAPACITY };

	if (larger.capacity > SIZE_MAX / sizeof(*larger.slots))
		return -ENOMEM;
	larger.slots = malloc(larger.capacity * sizeof(*larger.slots));
	if (!larger.slots)
		return -ENOMEM;
	map_clear(&larger);
	for (size_t i = 0; i < map->capacity; i++) {
		const struct map_slot *slot = &map->slots[i];

		if (slot->value != MAP_NONE)
			*slot_of(&larger, (map_key)slot->high << 64 | slot->low) = *slot;
	}
	larger.count = map->count;
	free(map->slots);
	*map = larger;
	return 0;
}

static int put(struct map *map, map_key key, uint64_t value, bool replace)
{
	struct map_slot *slot;

	if (2 * (map->count + 1) > map->capacity && enlarge(map) < 0)
		return -ENOMEM;
	slot = slot_of(map, key);
	if (slot->value != MAP_NONE) {
		if (replace)
			slot->value = value;
		return 0;
	}
	*slot = (struct map_slot){ (uint64_t)key, (uint64_t)(key >> 64), value };
	map->count++;
	return 1;
}

int map_set(struct map *map, map_key key, uint64_t value)
{
	int rc = put(map, key, value, true);

	return rc < 0 ? rc : 0;
}

int map_add(struct map *map, map_key key, uint64_t value)
{
	return put(map, key, value, false);
}

void map_remove(struct map *map, map_key key)
{
	const size_t mask = map->capacity - 1;
	size_t hole;

	if (map->count == 0 || slot_of(map, key)->value == MAP_NONE)
		return;
	hole = (size_t)(slot_of(map, key) - map->slots);
	for (size_t at = (hole + 1) & mask; map->slots[at].value != MAP_NONE;
	     at = (at + 1) & mask) {
		size_t home = home_of(map, map->slots[at].low, map->slots[at].high);

		/* An entry may move back to the hole unless its home lies behind the hole. */
		if (((at - home) & mask) < ((at - hole) & mask))
			continue;
		map->slots[hole] = map->slots[at];
		hole = at;
	}
	map->slots[hole].value = MAP_NONE;
	map->count--;
}

static const struct map_slot *next_slot(const struct map *map, size_t *at)
{
	while (*at < map->capacity) {
		const struct map_slot *slot = &map->slots[(*at)++];

		if (slot->value != MAP_NONE)
			return slot;
	}
	return NULL;
}

uint64_t map_next(const struct map *map, size_t *at)
{
	const struct map_slot *slot = next_slot(map, at);

	return slot ? slot->value : MAP_NONE;
}

bool map_next_key(const struct map *map, size_t *at, map_key *key)
{
	const struct map_slot *slot = next_slot(map, at);

	if (slot)
		*key = (map_key)slot->high << 64 | slot->low;
	return slot != NULL;
}
