/* Implements the hash map with open addressing and linear probing. There are no tombstones: removal
 * shifts the following entries back. The key is already a hash, so its first 8 bytes select the
 * slot. */
#include "net/by_hash.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

void by_hash_finish(struct by_hash *map)
{
	free(map->slots);
	*map = (struct by_hash){ 0 };
}

static size_t home_of(const struct by_hash *map, const struct hash *key)
{
	uint64_t bits;

	memcpy(&bits, key->bytes, sizeof(bits));
	return (size_t)bits & (map->capacity - 1);
}

/* Returns the slot that holds the key, or the free slot where it would be inserted. */
static size_t slot_of(const struct by_hash *map, const struct hash *key)
{
	size_t at = home_of(map, key);

	while (map->slots[at] && !hash_equal(map->slots[at]->key, *key))
		at = (at + 1) & (map->capacity - 1);
	return at;
}

void *by_hash_find(const struct by_hash *map, struct hash key)
{
	return map->count ? map->slots[slot_of(map, &key)] : NULL;
}

static int grow(struct by_hash *map)
{
	struct by_hash larger = { .capacity = map->capacity ? map->capacity * 2 : 64,
				  .count = map->count };

	larger.slots = calloc(larger.capacity, sizeof(struct hash_entry *));
	if (!larger.slots)
		return -ENOMEM;
	for (size_t i = 0; i < map->capacity; i++)
		if (map->slots[i])
			larger.slots[slot_of(&larger, &map->slots[i]->key)] = map->slots[i];
	free(map->slots);
	*map = larger;
	return 0;
}

int by_hash_add(struct by_hash *map, struct hash_entry *entry)
{
	if (map->count * 4 >= map->capacity * 3) {
		int rc = grow(map);

		if (rc < 0)
			return rc;
	}
	map->slots[slot_of(map, &entry->key)] = entry;
	map->count++;
	return 0;
}

void by_hash_remove(struct by_hash *map, struct hash key)
{
	size_t hole, at, mask = map->capacity - 1;

	if (!map->count)
		return;
	hole = slot_of(map, &key);
	if (!map->slots[hole])
		return;
	for (at = (hole + 1) & mask; map->slots[at]; at = (at + 1) & mask) {
		size_t home = home_of(map, &map->slots[at]->key);

		/* An entry may move back to the hole unless its home slot lies behind the hole. */
		if (((at - home) & mask) >= ((at - hole) & mask)) {
			map->slots[hole] = map->slots[at];
			hole = at;
		}
	}
	map->slots[hole] = NULL;
	map->count--;
}

void *by_hash_next(const struct by_hash *map, size_t *at)
{
	while (*at < map->capacity) {
		struct hash_entry *entry = map->slots[(*at)++];

		if (entry)
			return entry;
	}
	return NULL;
}
