/* A hash table with linear probing that grows when it is half full. */
#include "pipeline/release/object_map.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static struct hash_map_entry *slot_of(struct hash_map_entry *entries, size_t capacity,
				      struct hash hash)
{
	uint64_t start;

	memcpy(&start, hash.bytes, sizeof(start));
	for (size_t i = (size_t)start & (capacity - 1);; i = (i + 1) & (capacity - 1))
		if (!entries[i].used || hash_equal(entries[i].hash, hash))
			return &entries[i];
}

static int grow(struct hash_map *map)
{
	size_t capacity = map->capacity ? map->capacity * 2 : 64;
	struct hash_map_entry *entries = calloc(capacity, sizeof(*entries));

	if (!entries)
		return -ENOMEM;
	for (size_t i = 0; i < map->capacity; i++)
		if (map->entries[i].used)
			*slot_of(entries, capacity, map->entries[i].hash) = map->entries[i];
	free(map->entries);
	map->entries = entries;
	map->capacity = capacity;
	return 0;
}

int hash_map_put(struct hash_map *map, struct hash hash, uint64_t value)
{
	struct hash_map_entry *entry;

	if (map->count * 2 >= map->capacity && grow(map) < 0)
		return -ENOMEM;
	entry = slot_of(map->entries, map->capacity, hash);
	if (entry->used)
		return 0;
	*entry = (struct hash_map_entry){ .hash = hash, .value = value, .used = true };
	map->count++;
	return 1;
}

bool hash_map_get(const struct hash_map *map, struct hash hash, uint64_t *value)
{
	const struct hash_map_entry *entry;

	if (map->count == 0)
		return false;
	entry = slot_of(map->entries, map->capacity, hash);
	if (!entry->used)
		return false;
	if (value)
		*value = entry->value;
	return true;
}

void hash_map_finish(struct hash_map *map)
{
	if (!map)
		return;
	free(map->entries);
	*map = (struct hash_map){ 0 };
}
