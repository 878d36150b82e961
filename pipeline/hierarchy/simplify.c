/* Edge-collapse simplification with a priority queue of quadric errors. */
#include "pipeline/hierarchy/simplify.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "pipeline/hierarchy/collapse.h"

#define COLOUR_WEIGHT 0.005 /* of black to white, relative to moving the edge by its length */
#define SHAPE_WEIGHT  1e-6  /* on flat surfaces, short edges go first */
#define FOLD_COSINE   0.2   /* minimum cosine between a triangle's normals before and after */

struct candidate {
	uint32_t a, b;
	uint32_t stamp; /* sum of both vertices' versions; they only increase */
};

/* Costs are not negative, so their bits are in the order of their values. */
struct entry {
	uint32_t candidate, cost;
};

struct work {
	struct collapse_mesh mesh;
	struct candidate *candidates; /* all that were ever in the heap */
	struct entry *heap;
	uint32_t candidate_count, candidate_room, heap_count, heap_room;
	double worst; /* squared error so far, lattice steps */
	double most;  /* limit of worst */
	double loss;  /* loss of the costliest collapse */
	bool loose;   /* topology may change: the surface may pinch */
	uint32_t collapse_count;
	double colour_squares[256]; /* a third of the square of a difference of so many 255ths */
};

/* ---- the heap
 *
 * Four children a node: half the levels of two, and the four lie in one line of the cache. */

enum { CHILDREN = 4 };

static int push(struct work *work, float cost, struct candidate candidate)
{
	struct entry entry = { .candidate = work->candidate_count };
	size_t at = work->heap_count;
	int rc = ARRAY_RESERVE(work->heap, work->heap_room, at + 1, UINT32_MAX);

	if (rc == 0)
		rc = ARRAY_RESERVE(work->candidates, work->candidate_room,
				   (uint64_t)work->candidate_count + 1, UINT32_MAX);
	if (rc < 0)
		return rc;
	memcpy(&entry.cost, &cost, sizeof(cost));
	work->candidates[work->candidate_count++] = candidate;
	work->heap_count++;
	while (at > 0 && work->heap[(at - 1) / CHILDREN].cost > entry.cost) {
		work->heap[at] = work->heap[(at - 1) / CHILDREN];
		at = (at - 1) / CHILDREN;
	}
	work->heap[at] = entry;
	return 0;
}

/* Returns the least of the children that start there, of equals the first, without a branch: which
 * it is cannot be foretold. */
static size_t least_child(const struct entry *heap, size_t first)
{
	uint64_t keys[CHILDREN], low, high;

	for (size_t i = 0; i < CHILDREN; i++)
		keys[i] = (uint64_t)heap[first + i].cost << 32 | i;
	low = keys[0] < keys[1] ? keys[0] : keys[1];
	high = keys[2] < keys[3] ? keys[2] : keys[3];
	return first + (uint32_t)(low < high ? low : high);
}

/* The hole at the top sinks to the last level, and from there the last entry rises: it mostly stays
 * near. */
static struct candidate pop(struct work *work)
{
	struct entry *heap = work->heap, least = heap[0], last = heap[--work->heap_count];
	size_t at = 0, first;

	while ((first = CHILDREN * at + 1) + CHILDREN <= work->heap_count) {
		size_t child = least_child(heap, first);

		/* The children of these lie together: one is needed next. */
		__builtin_prefetch(&heap[CHILDREN * first + 1]);
		__builtin_prefetch(&heap[CHILDREN * first + 9]);
		__builtin_prefetch(&heap[CHILDREN * first + 16]);
		heap[at] = heap[child];
		at = child;
	}
	if (first < work->heap_count) {
		size_t child = first;

		for (size_t other = first + 1; other < work->heap_count; other++)
			if (heap[other].cost < heap[child].cost)
				child = other;
		heap[at] = heap[child];
		at = child;
	}
	while (at > 0 && heap[(at - 1) / CHILDREN].cost >= last.cost) {
		heap[at] = heap[(at - 1) / CHILDREN];
		at = (at - 1) / CHILDREN;
	}
	heap[at] = last;
	return work->candidates[least.candidate];
}

/* ---- cost of a collapse */

static bool is_fixed(const struct collapse_node *node)
{
	return node->locked || node->border;
}

static double squared_distance(const double a[3], const double b[3])
{
	double d[3] = { a[0] - b[0], a[1] - b[1], a[2] - b[2] };

	return collapse_dot(d, d);
}

static void round_to_lattice(double at[3], uint8_t fine_bits)
{
	const double last = (1 << (LATTICE_BITS + fine_bits)) - 1;

	for (int i = 0; i < 3; i++) {
		double steps = (at[i] > 0.0 ? at[i] : 0.0) + 0.5;

		at[i] = (int)(steps < last ? steps : last);
	}
}

/* Places the vertex of a collapse between two free vertices: at the best point, or in the middle if
 * the best point is far away. */
static double free_place(double out[3], const struct quadric *sum, const double a[3],
			 const double b[3], uint8_t fine_bits)
{
	double middle[3], square = squared_distance(a, b);

	for (int i = 0; i < 3; i++)
		middle[i] = (a[i] + b[i]) / 2.0;
	quadric_least(out, sum, middle);
	if (!(squared_distance(out, middle) <= square))
		memcpy(out, middle, sizeof(middle));
	round_to_lattice(out, fine_bits);
	return quadric_at(sum, out);
}

/* Decides which end stays and where it moves. Returns the quadric's value; negative: not
 * allowed. */
static double place_collapse(double out[3], uint32_t *keep, uint32_t *gone, struct work *work,
			     uint32_t a, uint32_t b)
{
	const struct collapse_node *node_a = &work->mesh.nodes[a], *node_b = &work->mesh.nodes[b];
	bool open = node_a->border && node_b->border && collapse_edge_is_open(&work->mesh, a, b);
	bool a_may = collapse_may_leave(node_a, node_b, open),
	     b_may = collapse_may_leave(node_b, node_a, open);
	bool a_fixed = is_fixed(node_a), b_fixed = is_fixed(node_b);
	double value_a, value_b;
	struct quadric sum;

	*keep = a;
	*gone = b;
	if (!a_may && !b_may)
		return -1.0;
	sum = node_a->quadric;
	quadric_add(&sum, &node_b->quadric);
	if (!a_fixed && !b_fixed)
		return free_place(out, &sum, node_a->at, node_b->at, work->mesh.surface->fine_bits);
	/* One end stays in its place: the one that may not leave, or the fixed one, or the better
	 * one. */
	value_a = b_may ? quadric_at(&sum, node_a->at) : INFINITY;
	value_b = a_may ? quadric_at(&sum, node_b->at) : INFINITY;
	if (b_may && a_fixed && !b_fixed)
		value_b = INFINITY;
	if (a_may && b_fixed && !a_fixed)
		value_a = INFINITY;
	if (value_b < value_a) {
		*keep = b;
		*gone = a;
	}
	memcpy(out, work->mesh.nodes[*keep].at, sizeof(node_a->at));
	return value_b < value_a ? value_b : value_a;
}

static double colour_distance(const struct work *work, uint32_t a, uint32_t b)
{
	const uint8_t *from = work->mesh.surface->vertices[a].colour;
	const uint8_t *to = work->mesh.surface->vertices[b].colour;
	double sum = 0.0;

	for (int i = 0; i < 3; i++)
		sum += work->colour_squares[abs(from[i] - to[i])];
	return sum;
}

static int push_edge(struct work *work, uint32_t a, uint32_t b)
{
	const struct collapse_node *node_a = &work->mesh.nodes[a], *node_b = &work->mesh.nodes[b];
	double at[3], square, cost;
	uint32_t keep, gone;

	cost = place_collapse(at, &keep, &gone, work, a, b);
	if (cost < 0.0)
		return 0;
	square = squared_distance(node_a->at, node_b->at);
	cost += square * (node_a->area < node_b->area ? node_a->area : node_b->area) *
		COLOUR_WEIGHT *
		(node_a->importance < node_b->importance ? node_a->importance
							 : node_b->importance) *
		colour_distance(work, a, b);
	cost += square * square * SHAPE_WEIGHT;
	return push(work, (float)cost,
		    (struct candidate){ a, b, node_a->version + node_b->version });
}

/* Both triangles of an edge would push it, one in each direction. Push it only from the smaller
 * end, or if the edge is open: then both ends lie on a border. (Both ends of an edge that is open
 * because the other triangle belongs to another group are locked, and it cannot collapse.) */
static int push_all_edges(struct work *work)
{
	int rc = 0;

	work->heap_count = work->candidate_count = 0;
	for (uint32_t t = 0; rc == 0 && t < work->mesh.surface->triangle_count; t++)
		for (int corner = 0; rc == 0 && !work->mesh.faces[t].dead && corner < 3; corner++) {
			uint32_t a = work->mesh.faces[t].corners[corner];
			uint32_t b = work->mesh.faces[t].corners[(corner + 1) % 3];

			if (a < b || (work->mesh.nodes[a].border && work->mesh.nodes[b].border &&
				      collapse_edge_is_open(&work->mesh, a, b)))
				rc = push_edge(work, a, b);
		}
	return rc;
}

/* ---- the collapse */

static void blend(struct work *work, uint32_t keep, uint32_t gone)
{
	struct lattice_vertex *to = &work->mesh.surface->vertices[keep];
	const struct lattice_vertex *from = &work->mesh.surface->vertices[gone];
	double sum = work->mesh.nodes[keep].area + work->mesh.nodes[gone].area;
	double share = sum > 0.0 ? work->mesh.nodes[gone].area / sum : 0.5;
	double normal[3], length;

	for (int i = 0; i < 4; i++)
		to->colour[i] =
			(uint8_t)(to->colour[i] + lrint(share * (from->colour[i] - to->colour[i])));
	to->seen = (uint8_t)(to->seen + lrint(share * (from->seen - to->seen)));
	work->mesh.nodes[keep].importance = collapse_importance(to);
	for (int i = 0; i < 3; i++)
		normal[i] = (1.0 - share) * to->normal[i] + share * from->normal[i];
	length = sqrt(collapse_dot(normal, normal));
	for (int i = 0; i < 3 && length > 1e-6; i++)
		to->normal[i] = (float)(normal[i] / length);
}

static int push_edges_of(struct work *work, uint32_t vertex)
{
	work->mesh.mark++;
	COLLAPSE_EACH_CORNER(&work->mesh, vertex, corner)
	{
		const uint32_t others[2] = { collapse_after(&work->mesh, corner),
					     collapse_before(&work->mesh, corner) };

		for (int i = 0; i < 2; i++) {
			struct collapse_node *other = &work->mesh.nodes[others[i]];

			if (other->mark == work->mesh.mark)
				continue;
			other->mark = work->mesh.mark;
			if (push_edge(work, vertex, others[i]) < 0)
				return -ENOMEM;
		}
	}
	return 0;
}

static int collapse(struct work *work, const struct candidate *candidate)
{
	struct lattice_vertex *vertices = work->mesh.surface->vertices;
	struct collapse_node *kept, *left;
	uint32_t keep, gone;
	double at[3], value, weight;

	value = place_collapse(at, &keep, &gone, work, candidate->a, candidate->b);
	kept = &work->mesh.nodes[keep];
	left = &work->mesh.nodes[gone];
	weight = kept->quadric.weight + left->quadric.weight;
	if (value < 0.0 || value > weight * work->most ||
	    collapse_is_last(&work->mesh, keep, gone) ||
	    (!work->loose && !collapse_link_is_sound(&work->mesh, keep, gone)) ||
	    collapse_folds(&work->mesh, gone, keep, at, FOLD_COSINE) ||
	    (!is_fixed(kept) && collapse_folds(&work->mesh, keep, gone, at, FOLD_COSINE)))
		return 0;
	if (weight > 0.0 && value / weight > work->worst)
		work->worst = value / weight;
	work->loss = fmax(work->loss, value);
	if (!kept->locked)
		blend(work, keep, gone);
	for (int i = 0; i < 3; i++) {
		kept->at[i] = at[i];
		vertices[keep].position[i] = (int32_t)at[i];
	}
	collapse_join(&work->mesh, keep, gone);
	kept->version++;
	left->version++;
	work->collapse_count++;
	return push_edges_of(work, keep);
}

static int collapse_until(struct work *work, uint32_t target)
{
	int rc = push_all_edges(work);

	while (rc == 0 && work->mesh.alive_count > target && work->heap_count > 0) {
		struct candidate least = pop(work);
		const struct collapse_node *a = &work->mesh.nodes[least.a],
					   *b = &work->mesh.nodes[least.b];

		if (a->first != COLLAPSE_NONE && b->first != COLLAPSE_NONE &&
		    least.stamp == a->version + b->version)
			rc = collapse(work, &least);
	}
	return rc;
}

static int work_init(struct work *work, struct simplify_surface *surface)
{
	size_t triangles = (size_t)surface->triangle_count + 1;
	int rc;

	*work = (struct work){ 0 };
	for (uint32_t i = 0; i < ARRAY_COUNT(work->colour_squares); i++)
		work->colour_squares[i] = i / 255.0 * (i / 255.0) / 3.0;
	rc = collapse_mesh_init(&work->mesh, surface);
	if (rc == 0)
		rc = ARRAY_RESERVE(work->heap, work->heap_room, 5 * triangles, UINT32_MAX);
	if (rc == 0)
		rc = ARRAY_RESERVE(work->candidates, work->candidate_room, 5 * triangles,
				   UINT32_MAX);
	return rc;
}

static void work_finish(struct work *work)
{
	collapse_mesh_finish(&work->mesh);
	free(work->candidates);
	free(work->heap);
}

int simplify(struct simplify_surface *surface, uint32_t target_triangles, double error_most_steps,
	     struct simplify_result *result)
{
	struct work work;
	uint32_t before;
	int rc = work_init(&work, surface);

	*result = (struct simplify_result){ 0 };
	work.most = error_most_steps * error_most_steps;
	if (rc == 0)
		rc = collapse_until(&work, target_triangles);
	/* If it is stuck, the topology of the surface is the obstacle. Let the surface pinch, as
	 * long as that helps. */
	work.loose = true;
	do {
		before = work.mesh.alive_count;
		if (rc == 0 && before > target_triangles)
			rc = collapse_until(&work, target_triangles);
	} while (rc == 0 && work.mesh.alive_count > target_triangles &&
		 work.mesh.alive_count < before - before / 16);
	if (rc == 0) {
		collapse_mesh_give_back(&work.mesh);
		result->error_steps = sqrt(work.worst);
		result->loss_steps4 = work.loss;
		result->collapse_count = work.collapse_count;
	}
	work_finish(&work);
	return rc;
}
