/* Goes through the edges by ranges of their lower end: those of a range are collected by counting
 * sort, so that equal edges become neighbours. Faces of a scan that are near each other in the file
 * mostly share vertices that are, so a range needs few of the blocks of faces. */
#include "pipeline/import/mesh_edges.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/spill.h"
#include "pipeline/import/mesh_places.h"

enum {
	/* Up to this many are sorted by insertion. A vertex has six edges on average, and half of
	 * them are stored here. */
	FEW = 64,
	EDGES_BIN = 4096,
	EDGES_BLOCK = 4096,
	RANGE_ITEMS = 8 << 20, /* 64 MB */
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

/* Returns the lower end of edge k of the face. *item is other end << 33 | (runs from lower to
 * other) << 32 | face. */
static uint32_t edge_of(const struct mesh_edges *edges, uint32_t face, int k, uint64_t *item)
{
	const uint32_t *triangle = edges->mesh->triangles[face];
	uint32_t a = edges->place[triangle[k]], b = edges->place[triangle[(k + 1) % 3]];

	*item = (uint64_t)(a < b ? b : a) << 33 | (uint64_t)(a < b) << 32 | face;
	return a < b ? a : b;
}

static uint32_t block_count(const struct mesh *mesh)
{
	return mesh->triangle_count / EDGES_BLOCK + 1;
}

static uint32_t bin_count(const struct mesh *mesh)
{
	return mesh->vertex_count / EDGES_BIN + 1;
}

static void survey(struct mesh_edges *edges)
{
	uint64_t item;

	for (uint32_t i = 0; i < block_count(edges->mesh); i++)
		edges->bounds[i][0] = UINT32_MAX;
	for (uint32_t i = 0; i < edges->mesh->triangle_count; i++) {
		uint32_t *bound = edges->bounds[i / EDGES_BLOCK];

		for (int k = 0; k < 3; k++) {
			uint32_t low = edge_of(edges, i, k, &item);

			edges->bins[low / EDGES_BIN]++;
			bound[0] = low < bound[0] ? low : bound[0];
			bound[1] = low > bound[1] ? low : bound[1];
		}
		spill_pass(i);
	}
}

int mesh_edges_init(struct mesh_edges *out, const struct mesh *mesh)
{
	int rc;

	*out = (struct mesh_edges){ .mesh = mesh, .place = mesh_places(mesh) };
	rc = out->place ? 0 : -errno;
	out->bins = calloc(bin_count(mesh), sizeof(*out->bins));
	out->bounds = calloc(block_count(mesh), sizeof(*out->bounds));
	if (rc == 0 && (!out->bins || !out->bounds))
		rc = -ENOMEM;
	if (rc == 0)
		survey(out);
	else
		mesh_edges_finish(out);
	return rc;
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
	uint32_t *start; /* index of the first item of each lower end, and the end; owned */
	uint64_t *items; /* sorted for each lower end; owned */
};

/* Calls take for each edge of the range. */
static void pass(const struct mesh_edges *edges, struct range *range,
		 void (*take)(struct range *range, uint32_t low, uint64_t item))
{
	const uint32_t faces = edges->mesh->triangle_count;

	for (uint32_t block = 0; block < block_count(edges->mesh); block++) {
		uint32_t first = block * EDGES_BLOCK;
		uint32_t after = faces - first < EDGES_BLOCK ? faces : first + EDGES_BLOCK;

		if (edges->bounds[block][0] >= range->end || edges->bounds[block][1] < range->low)
			continue;
		for (uint32_t i = first; i < after; i++)
			for (int k = 0; k < 3; k++) {
				uint64_t item;
				uint32_t low = edge_of(edges, i, k, &item);

				if (low >= range->low && low < range->end)
					take(range, low - range->low, item);
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

/* Advances range to the next bins that fit together, at least one. Returns false at the end. */
static bool next_range(const struct mesh_edges *edges, struct range *range)
{
	const struct mesh *mesh = edges->mesh;
	uint32_t bin = range->end / EDGES_BIN;

	range->low = range->end;
	range->item_count = 0;
	if (range->low >= mesh->vertex_count)
		return false;
	do
		range->item_count += edges->bins[bin++];
	while (bin < bin_count(mesh) && range->item_count + edges->bins[bin] <= RANGE_ITEMS);
	range->end = bin < bin_count(mesh) ? bin * EDGES_BIN : mesh->vertex_count;
	return true;
}

/* One vertex may have 4 thousand million edges, so a count needs all of its 32 bits, and no more: a
 * range of one bin has the edges of at most all faces. */
static int each_of_range(const struct mesh_edges *edges, struct range *range,
			 void (*visit)(void *data, const struct mesh_edge *edge), void *data)
{
	int rc = -ENOMEM;

	if (range->item_count > UINT32_MAX - 2)
		return -EFBIG;
	range->start = malloc(((size_t)(range->end - range->low) + 2) * sizeof(*range->start));
	range->items = malloc((size_t)range->item_count * sizeof(*range->items) + 1);
	if (range->start && range->items) {
		collect(edges, range);
		visit_range(range, visit, data);
		rc = 0;
	}
	free(range->start);
	free(range->items);
	return rc;
}

int mesh_edges_each(const struct mesh_edges *edges,
		    void (*visit)(void *data, const struct mesh_edge *edge), void *data)
{
	struct range range = { 0 };
	int rc = 0;

	while (rc == 0 && next_range(edges, &range))
		rc = each_of_range(edges, &range, visit, data);
	return rc;
}
