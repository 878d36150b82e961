/* Finds equal vertices with a hash table (open addressing). */
#include "pipeline/import/mesh_places.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define NO_VERTEX UINT32_MAX

/* Adds a word to a hash. */
static uint64_t mix(uint64_t hash, uint64_t word)
{
	hash = (hash ^ word) * 0x9e3779b97f4a7c15u;
	return hash ^ (hash >> 32);
}

static uint64_t hash_words(uint64_t hash, const void *words, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		uint32_t word;

		memcpy(&word, (const uint8_t *)words + 4 * i, sizeof(word));
		hash = mix(hash, word);
	}
	return hash;
}

static uint64_t hash_vertex(const struct mesh *mesh, uint32_t i, bool place_only)
{
	uint64_t hash = hash_words(0, mesh->positions[i], 3);

	if (!place_only && mesh->colours)
		hash = hash_words(hash, mesh->colours[i], 1);
	if (!place_only && mesh->uvs)
		hash = hash_words(hash, mesh->uvs[i], 2);
	return hash;
}

static bool same_vertex(const struct mesh *mesh, uint32_t a, uint32_t b, bool place_only)
{
	if (memcmp(mesh->positions[a], mesh->positions[b], sizeof(mesh->positions[a])) != 0)
		return false;
	if (place_only)
		return true;
	return (!mesh->colours || memcmp(mesh->colours[a], mesh->colours[b], 4) == 0) &&
	       (!mesh->uvs || memcmp(mesh->uvs[a], mesh->uvs[b], sizeof(mesh->uvs[a])) == 0);
}

/* first[i] is the first vertex that equals vertex i. Owned by the caller; NULL: no memory. */
static uint32_t *find_first_equals(const struct mesh *mesh, bool place_only)
{
	size_t slots = 16;
	uint32_t *table, *first = malloc(((size_t)mesh->vertex_count + 1) * sizeof(*first));

	while (slots < (size_t)mesh->vertex_count + mesh->vertex_count / 2)
		slots *= 2;
	table = malloc(slots * sizeof(*table));
	if (!table || !first) {
		free(table);
		free(first);
		return NULL;
	}
	memset(table, 0xff, slots * sizeof(*table));
	for (uint32_t i = 0; i < mesh->vertex_count; i++) {
		size_t at = hash_vertex(mesh, i, place_only) & (slots - 1);

		while (table[at] != NO_VERTEX && !same_vertex(mesh, table[at], i, place_only))
			at = (at + 1) & (slots - 1);
		if (table[at] == NO_VERTEX)
			table[at] = i;
		first[i] = table[at];
	}
	free(table);
	return first;
}

uint32_t *mesh_places(const struct mesh *mesh)
{
	return find_first_equals(mesh, true);
}

uint32_t *mesh_equals(const struct mesh *mesh)
{
	return find_first_equals(mesh, false);
}
