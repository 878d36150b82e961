/* Finds equal vertices with hash tables (open addressing). They are not base/map because what makes
 * vertices equal takes up to 24 bytes, and because a scan may be larger than memory: its vertices
 * are divided, so that a table with 8 bytes a slot stays small. */
#include "pipeline/import/mesh_places.h"

#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/parallel.h"
#include "base/spill.h"

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

/* Equal vertices have equal hashes, so the vertices are divided by their hash into parts that are
 * searched one after the other, each with a table of bounded size. */
struct search {
	const struct mesh *mesh;
	bool place_only;
	uint32_t parts;
	size_t slots; /* of a table at first; a power of two */
	uint32_t *first;
};

enum { PART_VERTICES = 3 << 20 }; /* a table of 64 MB */

/* An entry of the table: the upper half of the hash, then the vertex. Returns false if more than
 * half of the table fills, which a file can bring about that was made for it. */
static bool find_in_part(const struct search *search, uint32_t part, uint64_t *table, size_t slots)
{
	const struct mesh *mesh = search->mesh;
	size_t used = 0;

	memset(table, 0xff, slots * sizeof(*table));
	for (uint32_t i = 0; i < mesh->vertex_count && used <= slots / 2; i++) {
		uint64_t hash = hash_vertex(mesh, i, search->place_only), upper = hash >> 32;
		size_t at = hash & (slots - 1);

		spill_pass(i);
		if (upper * search->parts >> 32 != part)
			continue;
		while ((uint32_t)table[at] != NO_VERTEX &&
		       (table[at] >> 32 != upper ||
			!same_vertex(mesh, (uint32_t)table[at], i, search->place_only)))
			at = (at + 1) & (slots - 1);
		if ((uint32_t)table[at] == NO_VERTEX) {
			table[at] = upper << 32 | i;
			used++;
		}
		search->first[i] = (uint32_t)table[at];
	}
	return used <= slots / 2;
}

static int find_part(void *user, uint32_t part, uint32_t worker)
{
	const struct search *search = user;
	size_t slots = search->slots;
	bool found = false;

	(void)worker;
	while (!found) {
		uint64_t *table = malloc(slots * sizeof(*table));

		if (!table)
			return -ENOMEM;
		found = find_in_part(search, part, table, slots);
		free(table);
		slots *= 2;
	}
	return 0;
}

/* first[i] is the first vertex that equals vertex i. Owned by the caller; NULL: errno. */
static uint32_t *find_first_equals(const struct mesh *mesh, bool place_only)
{
	struct search search = { .mesh = mesh,
				 .place_only = place_only,
				 .parts = mesh->vertex_count / PART_VERTICES + 1,
				 .slots = 16 };
	int rc;

	while (search.slots < 2 * (size_t)(mesh->vertex_count / search.parts) +
				      mesh->vertex_count / search.parts / 8)
		search.slots *= 2; /* the parts are not exactly equal */
	search.first = spill_alloc(((size_t)mesh->vertex_count + 1) * sizeof(*search.first));
	if (!search.first)
		return NULL;
	rc = parallel_run(parallel_cores(), search.parts, find_part, &search);
	if (rc == 0)
		return search.first;
	spill_free(search.first);
	errno = -rc;
	return NULL;
}

uint32_t *mesh_places(const struct mesh *mesh)
{
	return find_first_equals(mesh, true);
}

uint32_t *mesh_equals(const struct mesh *mesh)
{
	return find_first_equals(mesh, false);
}
