/* Goes through the edges by ranges of their lower end: those of a range are collected by counting
 * sort, so that equal edges become neighbours. Faces of a scan that are near each other in the file
 * mostly share vertices that are, so a range needs few of the blocks of faces. Several threads
 * collect ranges at a time; they take turns to visit them. */
#include "pipeline/import/mesh_edges.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/parallel.h"
#include "base/spill.h"
#include "pipeline/import/mesh_places.h"

enum {
	/* Up to this many are sorted by insertion. A vertex has six edges on average, and half of
	 * them are stored here. */
	FEW = 64,
	EDGES_BIN = 4096,
	EDGES_BLOCK = 4096,
	BLOCKS_PER_JOB = 16,
	COLLECTED_ITEMS = 16 << 20, /* of the ranges of all threads together: 128 MB */
	RANGE_ITEMS_MIN = 1 << 20,
};

static void sort_few(uint64_t *values, uint64_t count)
{
	for (uint64_t i = 1; i < count; i++) {
		uint64_t value = values[i], at = i;

		for (; at > 0 && values[at - 1] > value; at--)
			values[at] = values[at - 1];
		values[at] = value;
	}
}

static int compare_u64(const void *a, const void *b)
{
	uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;

	return x < y ? -1 : x > y;
}

/* An edge of a face: its lower end, and other end << 33 | (runs from lower to other) << 32 | face.
 */
struct item {
	uint32_t low;
	uint64_t value;
};

/* Inline, as is pass: both are the inner loop. */
static force_inline void edges_of(const struct mesh_edges *edges, uint32_t face,
				  struct item items[3])
{
	const uint32_t *triangle = edges->mesh->triangles[face];
	uint32_t ends[3];

	for (int k = 0; k < 3; k++)
		ends[k] = edges->place ? edges->place[triangle[k]] : triangle[k];
	for (int k = 0; k < 3; k++) {
		uint32_t a = ends[k], b = ends[(k + 1) % 3];

		items[k].low = a < b ? a : b;
		items[k].value = (uint64_t)(a < b ? b : a) << 33 | (uint64_t)(a < b) << 32 | face;
	}
}

static uint32_t block_count(const struct mesh *mesh)
{
	return mesh->triangle_count / EDGES_BLOCK + 1;
}

static uint32_t bin_count(const struct mesh *mesh)
{
	return mesh->vertex_count / EDGES_BIN + 1;
}

static int survey(void *user, uint32_t first, uint32_t after, uint32_t worker)
{
	struct mesh_edges *edges = user;
	uint32_t *bound = NULL, bin = 0, count = 0;
	struct item items[3];

	(void)worker;
	spill_breathe();
	for (uint32_t i = first; i < after; i++) {
		edges_of(edges, i, items);
		if (i % EDGES_BLOCK == 0) {
			bound = edges->bounds[i / EDGES_BLOCK];
			bound[0] = UINT32_MAX;
		}
		for (int k = 0; k < 3; k++) {
			uint32_t low = items[k].low;

			/* Neighbours are mostly of one bin, so threads seldom meet there. */
			if (low / EDGES_BIN != bin) {
				atomic_fetch_add(&edges->bins[bin], count);
				bin = low / EDGES_BIN;
				count = 0;
			}
			count++;
			bound[0] = low < bound[0] ? low : bound[0];
			bound[1] = low > bound[1] ? low : bound[1];
		}
	}
	atomic_fetch_add(&edges->bins[bin], count);
	return 0;
}

int mesh_edges_init_placed(struct mesh_edges *out, const struct mesh *mesh, uint32_t *place,
			   uint32_t jobs)
{
	int rc = -ENOMEM;

	*out = (struct mesh_edges){ .mesh = mesh, .place = place, .jobs = jobs };
	out->bins = calloc(bin_count(mesh), sizeof(*out->bins));
	out->bounds = calloc(block_count(mesh), sizeof(*out->bounds));
	if (out->bins && out->bounds)
		rc = parallel_ranges(jobs, mesh->triangle_count, BLOCKS_PER_JOB * EDGES_BLOCK,
				     survey, out);
	if (rc < 0)
		mesh_edges_finish(out);
	return rc;
}

int mesh_edges_init(struct mesh_edges *out, const struct mesh *mesh, uint32_t jobs)
{
	uint32_t *place;
	int rc = mesh_places(&place, mesh, jobs);

	*out = (struct mesh_edges){ 0 };
	return rc < 0 ? rc : mesh_edges_init_placed(out, mesh, place, jobs);
}

void mesh_edges_finish(struct mesh_edges *edges)
{
	if (!edges)
		return;
	spill_free(edges->place);
	free(edges->bins);
	free(edges->bounds);
	*edges = (struct mesh_edges){ 0 };
}

/* ---- going through them */

/* The edges whose lower end is at least low and below end. */
struct range {
	uint32_t low, end;
	uint64_t item_count;
	uint32_t *start; /* index of the first item of each lower end, and the end */
	uint64_t *items; /* sorted for each lower end */
};

/* What a worker collects its ranges in. */
struct room {
	size_t start_bytes, item_bytes;
	uint32_t *start; /* owned */
	uint64_t *items; /* owned */
};

/* Calls take for each edge of the range. */
static force_inline void pass(const struct mesh_edges *edges, struct range *range,
			      void (*take)(struct range *range, uint32_t low, uint64_t item))
{
	const uint32_t faces = edges->mesh->triangle_count;

	for (uint32_t block = 0; block < block_count(edges->mesh); block++) {
		uint32_t first = block * EDGES_BLOCK;
		uint32_t after = faces - first < EDGES_BLOCK ? faces : first + EDGES_BLOCK;

		if (edges->bounds[block][0] >= range->end || edges->bounds[block][1] < range->low)
			continue;
		for (uint32_t i = first; i < after; i++) {
			struct item items[3];

			edges_of(edges, i, items);
			for (int k = 0; k < 3; k++)
				if (items[k].low >= range->low && items[k].low < range->end)
					take(range, items[k].low - range->low, items[k].value);
		}
		spill_pass(first);
	}
}

static void count_item(struct range *range, uint32_t low, uint64_t item)
{
	(void)item;
	range->start[low + 2]++;
}

static void put_item(struct range *range, uint32_t low, uint64_t item)
{
	range->items[range->start[low + 1]++] = item;
}

static void collect(const struct mesh_edges *edges, struct range *range)
{
	uint32_t vertices = range->end - range->low;

	memset(range->start, 0, ((size_t)vertices + 2) * sizeof(*range->start));
	pass(edges, range, count_item);
	for (uint32_t i = 0; i < vertices; i++)
		range->start[i + 2] += range->start[i + 1];
	pass(edges, range, put_item);
	for (uint32_t i = 0; i < vertices; i++) {
		uint32_t count = range->start[i + 1] - range->start[i];

		if (count > FEW)
			qsort(range->items + range->start[i], count, sizeof(*range->items),
			      compare_u64);
		else
			sort_few(range->items + range->start[i], count);
	}
}

static void visit_range(const struct range *range,
			void (*visit)(void *data, const struct mesh_edge *edge), void *data)
{
	for (uint32_t vertex = 0; vertex < range->end - range->low; vertex++) {
		uint32_t end = range->start[vertex + 1], next;

		for (uint32_t i = range->start[vertex]; i < end; i = next) {
			const uint64_t *items = range->items + i;
			struct mesh_edge edge = { .ends = { range->low + vertex,
							    (uint32_t)(items[0] >> 33) },
						  .faces = { (uint32_t)items[0] } };

			for (next = i + 1; next < end && range->items[next] >> 33 == *items >> 33;)
				next++;
			edge.face_count = next - i;
			if (edge.face_count > 1)
				edge.faces[1] = (uint32_t)items[1];
			edge.turned = edge.face_count == 2 && items[0] >> 32 == items[1] >> 32;
			visit(data, &edge);
		}
	}
}

/* The ranges, and whose turn it is. */
struct division {
	const struct mesh_edges *edges;
	void (*visit)(void *data, const struct mesh_edge *edge);
	void *data;
	uint32_t count;
	struct range *ranges; /* without items; owned */
	struct room *rooms;   /* of each worker; owned */
	pthread_mutex_t lock; /* guards the fields below */
	pthread_cond_t moved;
	uint32_t turn; /* the range to be visited next */
	bool failed;
};

/* Moves range to the next bins that fit together, at least one. Returns false at the end. */
static bool next_range(const struct mesh_edges *edges, struct range *range)
{
	const struct mesh *mesh = edges->mesh;
	const uint64_t share = COLLECTED_ITEMS / edges->jobs;
	const uint64_t most = share > RANGE_ITEMS_MIN ? share : RANGE_ITEMS_MIN;
	uint32_t bin = range->end / EDGES_BIN;

	range->low = range->end;
	range->item_count = 0;
	if (range->low >= mesh->vertex_count)
		return false;
	do
		range->item_count += edges->bins[bin++];
	while (bin < bin_count(mesh) && range->item_count + edges->bins[bin] <= most);
	range->end = bin < bin_count(mesh) ? bin * EDGES_BIN : mesh->vertex_count;
	return true;
}

static int divide(struct division *division)
{
	struct range range = { 0 };
	uint32_t room = 0;

	while (next_range(division->edges, &range)) {
		int rc = ARRAY_RESERVE(division->ranges, room, division->count + 1, UINT32_MAX);

		if (rc < 0)
			return rc;
		division->ranges[division->count++] = range;
	}
	return 0;
}

/* Waits until all ranges before are visited. Ranges are begun in order, so the threads that have
 * those do not wait for this one. Returns false if one of them failed. */
static bool await_turn(struct division *division, uint32_t number)
{
	bool failed;

	pthread_mutex_lock(&division->lock);
	while (division->turn != number)
		pthread_cond_wait(&division->moved, &division->lock);
	failed = division->failed;
	pthread_mutex_unlock(&division->lock);
	return !failed;
}

static void end_turn(struct division *division, int rc)
{
	pthread_mutex_lock(&division->lock);
	division->turn++;
	division->failed |= rc < 0;
	pthread_cond_broadcast(&division->moved);
	pthread_mutex_unlock(&division->lock);
}

/* Makes sure that *memory has so many bytes, whose contents are undefined. */
static int ensure(void *memory, size_t *has_bytes, size_t bytes)
{
	void *old, *larger;

	if (*has_bytes >= bytes)
		return 0;
	memcpy(&old, memory, sizeof(old));
	free(old);
	larger = malloc(bytes);
	memcpy(memory, &larger, sizeof(larger));
	*has_bytes = larger ? bytes : 0;
	return larger ? 0 : -ENOMEM;
}

/* One vertex may have 4 thousand million edges, so a count needs all of its 32 bits, and no more: a
 * range of one bin has the edges of at most all faces. */
static int make_room(struct range *range, struct room *room)
{
	int rc = range->item_count > UINT32_MAX - 2 ? -EFBIG : 0;

	if (rc == 0)
		rc = ensure(&room->start, &room->start_bytes,
			    ((size_t)(range->end - range->low) + 2) * sizeof(*room->start));
	if (rc == 0)
		rc = ensure(&room->items, &room->item_bytes,
			    (size_t)range->item_count * sizeof(*room->items) + 1);
	range->start = room->start;
	range->items = room->items;
	return rc;
}

static int do_range(void *user, uint32_t number, uint32_t worker)
{
	struct division *division = user;
	struct range range = division->ranges[number];
	int rc = make_room(&range, &division->rooms[worker]);

	if (rc == 0)
		collect(division->edges, &range);
	if (await_turn(division, number) && rc == 0)
		visit_range(&range, division->visit, division->data);
	end_turn(division, rc);
	return rc;
}

int mesh_edges_each(const struct mesh_edges *edges,
		    void (*visit)(void *data, const struct mesh_edge *edge), void *data)
{
	struct division division = { .edges = edges, .visit = visit, .data = data };
	int rc = divide(&division);

	division.rooms = calloc(edges->jobs, sizeof(*division.rooms));
	if (rc == 0 && !division.rooms)
		rc = -ENOMEM;
	pthread_mutex_init(&division.lock, NULL);
	pthread_cond_init(&division.moved, NULL);
	if (rc == 0)
		rc = parallel_run(edges->jobs, division.count, do_range, &division);
	pthread_cond_destroy(&division.moved);
	pthread_mutex_destroy(&division.lock);
	for (uint32_t i = 0; division.rooms && i < edges->jobs; i++) {
		free(division.rooms[i].start);
		free(division.rooms[i].items);
	}
	free(division.rooms);
	free(division.ranges);
	return rc;
}
