/* Finds equal vertices with hash tables (open addressing). They are not base/map because what makes
 * vertices equal takes up to 24 bytes, and because a scan may be larger than memory.
 *
 * Equal vertices have equal hashes. So the vertices are sorted into parts by the upper half of
 * their hash, each part in the order of the mesh, and the parts are searched independently, each
 * with a table that fits in a core's cache. The vertices themselves are only looked at again where
 * the lower halves are equal too. */
#include "pipeline/import/mesh_places.h"

#include <errno.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/parallel.h"
#include "base/spill.h"

#define NO_VERTEX UINT32_MAX

enum {
	PART_VERTICES = 56 << 10, /* a table of 1 MB */
	PARTS_MAX = 4096,
	RANGE_VERTICES = 1 << 16, /* that one thread sorts at a time, at least */
	RANGES_MAX = 1024,
};

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

static bool same_place(const struct mesh *mesh, uint32_t a, uint32_t b)
{
	return memcmp(mesh->positions[a], mesh->positions[b], sizeof(mesh->positions[a])) == 0;
}

/* Whether two vertices at one place are equal. */
static bool same_looks(const struct mesh *mesh, uint32_t a, uint32_t b)
{
	return (!mesh->colours || memcmp(mesh->colours[a], mesh->colours[b], 4) == 0) &&
	       (!mesh->uvs || memcmp(mesh->uvs[a], mesh->uvs[b], sizeof(mesh->uvs[a])) == 0);
}

/* ---- the search */

/* The table of one worker. */
struct table {
	uint64_t *entries; /* owned */
	size_t slots;      /* a power of two; 0 at first */
};

struct search {
	const struct mesh *mesh;
	bool place_only; /* otherwise those are searched for which found is NO_VERTEX */
	uint32_t jobs, parts, ranges, range_vertices;
	/* For each range of vertices and part: how many there are, then the index of the next
	 * entry; owned. */
	uint32_t *starts;
	/* The lower half of each vertex's hash, then the vertex; sorted by parts; owned. */
	uint64_t *entries;
	struct table *tables; /* of each worker; owned */
	uint32_t *found;      /* the result */
	atomic_bool has_equals;
};

static uint64_t hash_vertex(const struct search *search, uint32_t i)
{
	const struct mesh *mesh = search->mesh;
	uint64_t hash = hash_words(0, mesh->positions[i], 3);

	if (!search->place_only && mesh->colours)
		hash = hash_words(hash, mesh->colours[i], 1);
	if (!search->place_only && mesh->uvs)
		hash = hash_words(hash, mesh->uvs[i], 2);
	return hash;
}

static bool is_searched(const struct search *search, uint32_t i)
{
	return search->place_only || search->found[i] == NO_VERTEX;
}

static uint32_t part_of(const struct search *search, uint64_t hash)
{
	return (uint32_t)((hash >> 32) * search->parts >> 32);
}

static uint32_t *starts_of(const struct search *search, uint32_t first)
{
	return search->starts + (size_t)(first / search->range_vertices) * search->parts;
}

static int count_range(void *user, uint32_t first, uint32_t after, uint32_t worker)
{
	const struct search *search = user;
	uint32_t *counts = starts_of(search, first);

	(void)worker;
	for (uint32_t i = first; i < after; i++) {
		if (is_searched(search, i))
			counts[part_of(search, hash_vertex(search, i))]++;
		spill_pass(i);
	}
	return 0;
}

/* Turns the counts into the index of each range's first entry. Returns the number of entries. */
static uint32_t sum_counts(struct search *search)
{
	uint32_t sum = 0;

	for (uint32_t part = 0; part < search->parts; part++)
		for (uint32_t range = 0; range < search->ranges; range++) {
			uint32_t *start = &search->starts[(size_t)range * search->parts + part];
			uint32_t count = *start;

			*start = sum;
			sum += count;
		}
	return sum;
}

static int sort_range(void *user, uint32_t first, uint32_t after, uint32_t worker)
{
	const struct search *search = user;
	uint32_t *starts = starts_of(search, first);

	(void)worker;
	for (uint32_t i = first; i < after; i++) {
		uint64_t hash;

		spill_pass(i);
		if (!is_searched(search, i))
			continue;
		hash = hash_vertex(search, i);
		search->entries[starts[part_of(search, hash)]++] = hash << 32 | i;
		search->found[i] = i;
	}
	return 0;
}

/* The end of a part's entries, once all ranges are sorted. */
static uint32_t end_of_part(const struct search *search, uint32_t part)
{
	return search->starts[(size_t)(search->ranges - 1) * search->parts + part];
}

/* Returns false if more than half of the table fills, which a file can bring about that was made
 * for it. */
static bool find_in_part(struct search *search, uint32_t part, const struct table *table)
{
	const uint32_t end = end_of_part(search, part);
	size_t used = 0;

	memset(table->entries, 0xff, table->slots * sizeof(*table->entries));
	for (uint32_t i = part ? end_of_part(search, part - 1) : 0;
	     i < end && used <= table->slots / 2; i++) {
		uint64_t entry = search->entries[i];
		uint32_t vertex = (uint32_t)entry, other;
		size_t at = (entry >> 32) & (table->slots - 1);

		spill_pass(i);
		while ((other = (uint32_t)table->entries[at]) != NO_VERTEX &&
		       (table->entries[at] >> 32 != entry >> 32 ||
			!same_place(search->mesh, other, vertex) ||
			!(search->place_only || same_looks(search->mesh, other, vertex))))
			at = (at + 1) & (table->slots - 1);
		if (other != NO_VERTEX) {
			search->found[vertex] = other;
			atomic_store_explicit(&search->has_equals, true, memory_order_relaxed);
		} else {
			table->entries[at] = entry;
			used++;
		}
	}
	return used <= table->slots / 2;
}

static int resize_table(struct table *table, size_t slots)
{
	free(table->entries);
	table->entries = malloc(slots * sizeof(*table->entries));
	table->slots = table->entries ? slots : 0;
	return table->entries ? 0 : -ENOMEM;
}

static int find_part(void *user, uint32_t part, uint32_t worker)
{
	struct search *search = user;
	struct table *table = &search->tables[worker];
	int rc = 0;

	if (table->slots == 0) {
		size_t slots = 16;

		/* the parts are not exactly equal */
		while (slots < 2 * PART_VERTICES + PART_VERTICES / 8 &&
		       slots < 2 * (size_t)search->mesh->vertex_count)
			slots *= 2;
		rc = resize_table(table, slots);
	}
	while (rc == 0 && !find_in_part(search, part, table))
		rc = resize_table(table, 2 * table->slots);
	return rc;
}

static int run_search(struct search *search)
{
	const uint32_t vertices = search->mesh->vertex_count;
	int rc = parallel_ranges(search->jobs, vertices, search->range_vertices, count_range,
				 search);

	if (rc < 0)
		return rc;
	search->entries = spill_alloc(((size_t)sum_counts(search) + 1) * sizeof(*search->entries));
	if (!search->entries)
		return -errno;
	rc = parallel_ranges(search->jobs, vertices, search->range_vertices, sort_range, search);
	return rc < 0 ? rc : parallel_run(search->jobs, search->parts, find_part, search);
}

/* Fills search->found for the count vertices to be searched. */
static int find(struct search *search, uint32_t count)
{
	const uint32_t vertices = search->mesh->vertex_count;
	int rc = -ENOMEM;

	search->parts = 1;
	while (search->parts < PARTS_MAX && count / search->parts > PART_VERTICES)
		search->parts *= 2;
	search->range_vertices = vertices / RANGES_MAX + 1;
	if (search->range_vertices < RANGE_VERTICES)
		search->range_vertices = RANGE_VERTICES;
	search->ranges = (vertices - 1) / search->range_vertices + 1;
	search->starts = calloc((size_t)search->ranges * search->parts, sizeof(*search->starts));
	search->tables = calloc(search->jobs, sizeof(*search->tables));
	if (search->starts && search->tables)
		rc = run_search(search);
	for (uint32_t i = 0; search->tables && i < search->jobs; i++)
		free(search->tables[i].entries);
	free(search->tables);
	free(search->starts);
	spill_free(search->entries);
	return rc;
}

int mesh_places(uint32_t **out, const struct mesh *mesh, uint32_t jobs)
{
	struct search search = { .mesh = mesh, .place_only = true, .jobs = jobs };
	int rc;

	*out = NULL;
	if (mesh->vertex_count == 0)
		return 0;
	search.found = spill_alloc((size_t)mesh->vertex_count * sizeof(*search.found));
	if (!search.found)
		return -errno;
	rc = find(&search, mesh->vertex_count);
	if (rc == 0 && atomic_load(&search.has_equals))
		*out = search.found;
	else
		spill_free(search.found);
	return rc;
}

/* ---- vertices at one place that differ */

struct comparison {
	const struct mesh *mesh;
	const uint32_t *place;
	uint32_t *found; /* NULL: they are only counted */
	atomic_uint different;
};

/* Compares each vertex with the first at its place. Those that differ from it can only be equal to
 * one another. */
static int compare_range(void *user, uint32_t first, uint32_t after, uint32_t worker)
{
	struct comparison *comparison = user;
	uint32_t different = 0;

	(void)worker;
	for (uint32_t i = first; i < after; i++) {
		uint32_t place = comparison->place[i];
		bool differs = place != i && !same_looks(comparison->mesh, place, i);

		different += differs;
		if (comparison->found)
			comparison->found[i] = differs ? NO_VERTEX : place;
		spill_pass(i);
	}
	atomic_fetch_add(&comparison->different, different);
	return 0;
}

int mesh_equals(uint32_t **out, const struct mesh *mesh, uint32_t *place, uint32_t jobs)
{
	struct comparison comparison = { .mesh = mesh, .place = place };
	struct search search = { .mesh = mesh, .jobs = jobs };
	uint32_t count;
	int rc;

	*out = place;
	if (!place || (!mesh->colours && !mesh->uvs))
		return 0;
	rc = parallel_ranges(jobs, mesh->vertex_count, RANGE_VERTICES, compare_range, &comparison);
	count = atomic_load(&comparison.different);
	if (rc < 0 || count == 0)
		return rc;
	*out = NULL;
	search.found = spill_alloc((size_t)mesh->vertex_count * sizeof(*search.found));
	if (!search.found)
		return -errno;
	comparison.found = search.found;
	rc = parallel_ranges(jobs, mesh->vertex_count, RANGE_VERTICES, compare_range, &comparison);
	if (rc == 0)
		rc = find(&search, count);
	if (rc == 0)
		*out = search.found;
	else
		spill_free(search.found);
	return rc;
}
