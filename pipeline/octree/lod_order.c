/* Opens the nodes one after the other and keeps count of the triangles. */
#include "pipeline/octree/lod_order.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/octree/lod_polygon.h"

struct ordering {
	struct lod_tree *tree;
	struct lod_order *order;
	const float *gains; /* of each node */
	uint32_t *heap;     /* nodes that may be opened next, the best first; owned */
	uint32_t heap_count;
	uint8_t *counts; /* triangles of each node that is there; owned */
	uint8_t *levels; /* of each node; owned */
	uint64_t triangles;
};

/* ---- the queue: a binary heap */

static bool comes_first(const struct ordering *ordering, uint32_t a, uint32_t b)
{
	if (ordering->gains[a] != ordering->gains[b])
		return ordering->gains[a] > ordering->gains[b];
	return a < b;
}

static void push(struct ordering *ordering, uint32_t node)
{
	uint32_t *heap = ordering->heap, at = ordering->heap_count++;

	for (; at > 0 && comes_first(ordering, node, heap[(at - 1) / 2]); at = (at - 1) / 2)
		heap[at] = heap[(at - 1) / 2];
	heap[at] = node;
}

static uint32_t pop(struct ordering *ordering)
{
	uint32_t *heap = ordering->heap;
	const uint32_t best = heap[0], moved = heap[--ordering->heap_count];
	uint32_t at = 0;

	for (;;) {
		uint32_t child = 2 * at + 1;

		if (child + 1 < ordering->heap_count &&
		    comes_first(ordering, heap[child + 1], heap[child]))
			child++;
		if (child >= ordering->heap_count || !comes_first(ordering, heap[child], moved))
			break;
		heap[at] = heap[child];
		at = child;
	}
	heap[at] = moved;
	return best;
}

/* ---- opening */

static bool is_there(const struct ordering *ordering, uint32_t node)
{
	const uint32_t parent = ordering->tree->parents[node];

	return parent == LOD_NONE || ordering->tree->nodes[parent].number != LOD_NONE;
}

/* Returns a node that must be opened before this one, or LOD_NONE. */
static uint32_t blocker(const struct ordering *ordering, uint32_t node)
{
	const uint32_t level = ordering->levels[node];

	if (!is_there(ordering, node))
		return ordering->tree->parents[node];
	for (int i = 0; i < 27; i++) {
		const int shift[3] = { i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1 };
		uint32_t other;

		if (i == 13)
			continue;
		other = lod_neighbour(ordering->tree, level, node, shift);
		if (other != LOD_NONE && !is_there(ordering, other))
			return ordering->tree->parents[other];
	}
	return LOD_NONE;
}

static void recount(struct ordering *ordering, uint32_t node)
{
	struct lod_polygons polygons;
	uint32_t count;

	lod_polygons_find(&polygons, ordering->tree, &ordering->tree->nodes[node], LOD_NONE);
	count = lod_polygons_triangles(&polygons);
	ordering->triangles += count;
	ordering->triangles -= ordering->counts[node];
	ordering->counts[node] = (uint8_t)count;
}

/* Tells a neighbour that its face or edge is split. */
static void split(struct ordering *ordering, uint32_t node, const int shift[3], int face, int edge,
		  uint32_t number)
{
	const uint32_t other = lod_neighbour(ordering->tree, ordering->levels[node], node, shift);
	struct lod_node *neighbour;
	uint32_t *when;

	if (other == LOD_NONE)
		return;
	neighbour = &ordering->tree->nodes[other];
	when = face >= 0 ? &neighbour->face_split[face] : &neighbour->edge_split[edge];
	if (*when == LOD_NONE)
		*when = number;
	if (neighbour->number == LOD_NONE && is_there(ordering, other))
		recount(ordering, other);
}

static void split_around(struct ordering *ordering, uint32_t node, uint32_t number)
{
	for (int edge = 0; edge < CUBE_EDGES; edge++) {
		const int axis = edge / 4, first = (axis + 1) % 3, second = (axis + 2) % 3;

		/* the other three cubes around the edge */
		for (int i = 1; i < 4; i++) {
			int shift[3] = { 0 };

			if (i & 1)
				shift[first] = edge & 1 ? 1 : -1;
			if (i & 2)
				shift[second] = edge & 2 ? 1 : -1;
			split(ordering, node, shift, -1, edge ^ i, number);
		}
	}
	for (int face = 0; face < LOD_CUBE_FACES; face++) {
		int shift[3] = { 0 };

		shift[face / 2] = face % 2 ? 1 : -1;
		split(ordering, node, shift, face ^ 1, -1, number);
	}
}

static void open_node(struct ordering *ordering, uint32_t index)
{
	struct lod_order *order = ordering->order;
	struct lod_node *node = &ordering->tree->nodes[index];
	const uint32_t children = (uint32_t)__builtin_popcount(node->child_mask);

	node->number = order->count;
	ordering->triangles -= ordering->counts[index];
	ordering->counts[index] = 0;
	for (uint32_t i = 0; i < children; i++) {
		const uint32_t child = node->first_child + i;

		recount(ordering, child);
		if (ordering->tree->nodes[child].child_mask)
			push(ordering, child);
	}
	split_around(ordering, index, node->number);
	order->nodes[order->count++] = index;
	order->triangles[order->count] = (uint32_t)ordering->triangles;
}

/* Opens a node after all that must be opened before it; they are larger. */
static void open_with_needed(struct ordering *ordering, uint32_t node)
{
	uint32_t needed;

	while ((needed = blocker(ordering, node)) != LOD_NONE)
		open_with_needed(ordering, needed);
	open_node(ordering, node);
}

static void open_all(struct ordering *ordering)
{
	struct lod_order *order = ordering->order;

	recount(ordering, 0);
	order->triangles[0] = (uint32_t)ordering->triangles;
	if (ordering->tree->nodes[0].child_mask)
		push(ordering, 0);
	while (ordering->heap_count > 0) {
		const uint32_t node = pop(ordering);

		if (ordering->tree->nodes[node].number == LOD_NONE)
			open_with_needed(ordering, node);
	}
	for (uint32_t i = 0; i <= order->count; i++) {
		order->most[i] = order->triangles[i];
		if (i > 0 && order->most[i - 1] > order->most[i])
			order->most[i] = order->most[i - 1];
	}
}

/* ---- the whole */

static int allocate(struct ordering *ordering, uint32_t inner)
{
	struct lod_order *order = ordering->order;
	const size_t nodes = ordering->tree->level_first[ordering->tree->level_count];

	order->nodes = malloc((inner + (size_t)1) * sizeof(*order->nodes));
	order->triangles = malloc((inner + (size_t)1) * sizeof(*order->triangles));
	order->most = malloc((inner + (size_t)1) * sizeof(*order->most));
	ordering->heap = malloc((inner + (size_t)1) * sizeof(*ordering->heap));
	ordering->counts = calloc(nodes, sizeof(*ordering->counts));
	ordering->levels = malloc(nodes);
	if (!order->nodes || !order->triangles || !order->most || !ordering->heap ||
	    !ordering->counts || !ordering->levels)
		return -ENOMEM;
	return 0;
}

int lod_order_make(struct lod_order *out, struct lod_tree *tree, const float *gains)
{
	struct ordering ordering = { .tree = tree, .order = out, .gains = gains };
	/* the leaves lie behind all others */
	const uint32_t inner = tree->level_first[tree->level_count - 1];
	int rc;

	*out = (struct lod_order){ 0 };
	rc = allocate(&ordering, inner);
	if (rc == 0) {
		for (uint32_t level = 0; level < tree->level_count; level++)
			memset(ordering.levels + tree->level_first[level], (int)level,
			       tree->level_first[level + 1] - tree->level_first[level]);
		open_all(&ordering);
	}
	free(ordering.heap);
	free(ordering.counts);
	free(ordering.levels);
	if (rc < 0)
		lod_order_finish(out);
	return rc;
}

void lod_order_finish(struct lod_order *order)
{
	if (!order)
		return;
	free(order->nodes);
	free(order->triangles);
	free(order->most);
	*order = (struct lod_order){ 0 };
}

uint32_t lod_order_find(const struct lod_order *order, uint32_t triangles)
{
	uint32_t low = 0, high = order->count;

	while (low < high) {
		const uint32_t middle = low + (high - low + 1) / 2;

		if (order->most[middle] <= triangles)
			low = middle;
		else
			high = middle - 1;
	}
	return low;
}
