/* Edge-collapse simplification with a priority queue, quadrics and checks for folds and
 * topology. */
#include "pipeline/hierarchy/simplify.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "pipeline/hierarchy/quadric.h"

#define NONE          UINT32_MAX
#define BORDER_WEIGHT 20.0  /* of planes that hold open edges, times the edge's squared length */
#define COLOUR_WEIGHT 0.005 /* of black to white, relative to moving the edge by its length */
#define SHAPE_WEIGHT  1e-6  /* on flat surfaces, short edges go first */
#define FOLD_COSINE   0.2   /* minimum cosine between a triangle's normals before and after */
#define UNSEEN_WEIGHT 0.03  /* of invisible surface, relative to surface seen from all sides */

struct candidate {
	float cost;
	uint32_t a, b;
	uint32_t stamp; /* sum of both vertices' versions; they only increase */
};

struct work {
	struct simplify_surface *surface;
	struct quadric *quadrics;
	double *areas; /* for each vertex, to average normals and colours */
	/* Linked list of the corners at each vertex: corner 3 t + i is corner i of triangle t. */
	uint32_t *first, *next;
	uint8_t *dead; /* for each triangle */
	uint32_t *versions;
	uint32_t *marks, mark;
	struct candidate *heap;
	uint32_t heap_count, heap_room;
	uint32_t alive_count;
	double worst; /* squared error so far, lattice steps */
	double most;  /* limit of worst */
	double loss;  /* loss of the costliest collapse */
	bool loose;   /* topology may change: the surface may pinch */
	uint32_t collapse_count;
};

/* ---- the heap
 *
 * Four children a node: half the levels of two, and the four lie in one line of the cache. */

enum { CHILDREN = 4 };

static int push(struct work *work, struct candidate candidate)
{
	size_t at = work->heap_count;
	int rc = ARRAY_RESERVE(work->heap, work->heap_room, at + 1, UINT32_MAX);

	if (rc < 0)
		return rc;
	work->heap_count++;
	while (at > 0 && work->heap[(at - 1) / CHILDREN].cost > candidate.cost) {
		work->heap[at] = work->heap[(at - 1) / CHILDREN];
		at = (at - 1) / CHILDREN;
	}
	work->heap[at] = candidate;
	return 0;
}

static struct candidate pop(struct work *work)
{
	const struct candidate *heap = work->heap;
	struct candidate least = heap[0], last = heap[--work->heap_count];
	size_t at = 0, first;

	while ((first = CHILDREN * at + 1) < work->heap_count) {
		size_t end =
			first + CHILDREN < work->heap_count ? first + CHILDREN : work->heap_count;
		size_t child = first;

		for (size_t other = first + 1; other < end; other++)
			if (heap[other].cost < heap[child].cost)
				child = other;
		if (heap[child].cost >= last.cost)
			break;
		work->heap[at] = heap[child];
		at = child;
	}
	work->heap[at] = last;
	return least;
}

/* ---- the surface */

static bool has(const uint32_t triangle[3], uint32_t vertex)
{
	return triangle[0] == vertex || triangle[1] == vertex || triangle[2] == vertex;
}

/* Returns the next living corner at a vertex, and unlinks dead ones on the way. */
static uint32_t living(struct work *work, uint32_t *link)
{
	while (*link != NONE && work->dead[*link / 3])
		*link = work->next[*link];
	return *link;
}

#define EACH_CORNER(work, vertex, corner)                                                          \
	for (uint32_t *link_##corner = &(work)->first[vertex], corner;                             \
	     (corner = living(work, link_##corner)) != NONE;                                       \
	     link_##corner = &(work)->next[corner])

static void cross_of(double out[3], const double a[3], const double b[3], const double c[3])
{
	double u[3], v[3];

	for (int i = 0; i < 3; i++) {
		u[i] = b[i] - a[i];
		v[i] = c[i] - a[i];
	}
	for (int i = 0; i < 3; i++)
		out[i] = u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
}

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void place_of(double out[3], const struct work *work, uint32_t vertex)
{
	for (int i = 0; i < 3; i++)
		out[i] = work->surface->vertices[vertex].position[i];
}

static void cross_of_triangle(double out[3], const struct work *work, uint32_t t)
{
	double at[3][3];

	for (int corner = 0; corner < 3; corner++)
		place_of(at[corner], work, work->surface->triangles[t][corner]);
	cross_of(out, at[0], at[1], at[2]);
}

/* Counts the triangles at an edge; *forth is how many of them run from a to b. */
static uint32_t triangles_at_edge(struct work *work, uint32_t a, uint32_t b, uint32_t *forth)
{
	uint32_t count = 0;

	*forth = 0;
	EACH_CORNER(work, a, corner)
	{
		const uint32_t *triangle = work->surface->triangles[corner / 3];

		if (!has(triangle, b))
			continue;
		count++;
		*forth += triangle[(corner % 3 + 1) % 3] == b;
	}
	return count;
}

static bool edge_is_open(struct work *work, uint32_t a, uint32_t b)
{
	uint32_t forth, count = triangles_at_edge(work, a, b, &forth);

	return 2 * forth != count;
}

/* ---- quadrics */

/* Errors are weighted by visibility: "Visibility-guided simplification", Zhang and Turk 2002. */
static double importance(const struct lattice_vertex *vertex)
{
	return UNSEEN_WEIGHT + (1.0 - UNSEEN_WEIGHT) * vertex->seen / 255.0;
}

static void add_open_edge(struct work *work, uint32_t a, uint32_t b, const double normal[3],
			  double weight)
{
	double at[3], to[3], along[3], side[3], length;

	place_of(at, work, a);
	place_of(to, work, b);
	for (int i = 0; i < 3; i++)
		along[i] = to[i] - at[i];
	for (int i = 0; i < 3; i++)
		side[i] = along[(i + 1) % 3] * normal[(i + 2) % 3] -
			  along[(i + 2) % 3] * normal[(i + 1) % 3];
	length = sqrt(dot(side, side));
	if (length <= 0.0)
		return;
	for (int i = 0; i < 3; i++)
		side[i] /= length;
	weight *= BORDER_WEIGHT * dot(along, along);
	quadric_add_plane(&work->quadrics[a], side, at, weight);
	quadric_add_plane(&work->quadrics[b], side, at, weight);
}

static void add_triangle(struct work *work, uint32_t t)
{
	const uint32_t *triangle = work->surface->triangles[t];
	const struct lattice_vertex *vertices = work->surface->vertices;
	double normal[3], at[3], length, weight = 0.0;

	cross_of_triangle(normal, work, t);
	length = sqrt(dot(normal, normal));
	if (length <= 0.0)
		return;
	for (int i = 0; i < 3; i++)
		normal[i] /= length;
	place_of(at, work, triangle[0]);
	for (int corner = 0; corner < 3; corner++)
		weight += importance(&vertices[triangle[corner]]) / 3.0;
	for (int corner = 0; corner < 3; corner++) {
		uint32_t a = triangle[corner], b = triangle[(corner + 1) % 3];

		quadric_add_plane(&work->quadrics[a], normal, at, weight * length / 6.0);
		work->areas[a] += length / 6.0;
		if (vertices[a].border && vertices[b].border && edge_is_open(work, a, b))
			add_open_edge(work, a, b, normal, weight);
	}
}

/* ---- cost of a collapse */

/* Returns true if gone may be removed while keep stays. Open edges are only shortened along
 * themselves. */
static bool may_leave(struct work *work, uint32_t gone, uint32_t keep, bool open)
{
	const struct simplify_surface *surface = work->surface;

	if (surface->locked[gone])
		return false;
	return !surface->vertices[gone].border || (surface->vertices[keep].border && open);
}

static bool is_fixed(const struct work *work, uint32_t vertex)
{
	return work->surface->locked[vertex] || work->surface->vertices[vertex].border;
}

static void round_to_lattice(double at[3], uint8_t fine_bits)
{
	const double last = (1 << (LATTICE_BITS + fine_bits)) - 1;

	for (int i = 0; i < 3; i++)
		at[i] = fmin(fmax(round(at[i]), 0.0), last);
}

static double squared_distance(const double a[3], const double b[3])
{
	double d[3] = { a[0] - b[0], a[1] - b[1], a[2] - b[2] };

	return dot(d, d);
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
	bool open = work->surface->vertices[a].border && work->surface->vertices[b].border &&
		    edge_is_open(work, a, b);
	bool a_may = may_leave(work, a, b, open), b_may = may_leave(work, b, a, open);
	struct quadric sum = work->quadrics[a];
	double at_a[3], at_b[3], value_a, value_b;

	*keep = a;
	*gone = b;
	if (!a_may && !b_may)
		return -1.0;
	quadric_add(&sum, &work->quadrics[b]);
	place_of(at_a, work, a);
	place_of(at_b, work, b);
	if (!is_fixed(work, a) && !is_fixed(work, b))
		return free_place(out, &sum, at_a, at_b, work->surface->fine_bits);
	/* One end stays in its place: the one that may not leave, or the fixed one, or the better
	 * one. */
	value_a = b_may ? quadric_at(&sum, at_a) : INFINITY;
	value_b = a_may ? quadric_at(&sum, at_b) : INFINITY;
	if (b_may && is_fixed(work, a) && !is_fixed(work, b))
		value_b = INFINITY;
	if (a_may && is_fixed(work, b) && !is_fixed(work, a))
		value_a = INFINITY;
	if (value_b < value_a) {
		*keep = b;
		*gone = a;
	}
	memcpy(out, value_b < value_a ? at_b : at_a, sizeof(at_a));
	return fmin(value_a, value_b);
}

static double colour_distance(const struct lattice_vertex *a, const struct lattice_vertex *b)
{
	double sum = 0.0;

	for (int i = 0; i < 3; i++) {
		double d = (a->colour[i] - b->colour[i]) / 255.0;

		sum += d * d / 3.0;
	}
	return sum;
}

static int push_edge(struct work *work, uint32_t a, uint32_t b)
{
	const struct lattice_vertex *vertices = work->surface->vertices;
	double at[3], from[3], to[3], square, cost;
	uint32_t keep, gone;

	cost = place_collapse(at, &keep, &gone, work, a, b);
	if (cost < 0.0)
		return 0;
	place_of(from, work, a);
	place_of(to, work, b);
	square = squared_distance(from, to);
	cost += square * fmin(work->areas[a], work->areas[b]) * COLOUR_WEIGHT *
		fmin(importance(&vertices[a]), importance(&vertices[b])) *
		colour_distance(&vertices[a], &vertices[b]);
	cost += square * square * SHAPE_WEIGHT;
	return push(work,
		    (struct candidate){ (float)cost, a, b, work->versions[a] + work->versions[b] });
}

/* Both triangles of an edge would push it, one in each direction. Push it only from the smaller
 * end, or if the edge is open: then both ends lie on a border. (Both ends of an edge that is open
 * because the other triangle belongs to another group are locked, and it cannot collapse.) */
static int push_all_edges(struct work *work)
{
	const struct lattice_vertex *vertices = work->surface->vertices;
	int rc = 0;

	work->heap_count = 0;
	for (uint32_t t = 0; rc == 0 && t < work->surface->triangle_count; t++)
		for (int corner = 0; rc == 0 && !work->dead[t] && corner < 3; corner++) {
			uint32_t a = work->surface->triangles[t][corner];
			uint32_t b = work->surface->triangles[t][(corner + 1) % 3];

			if (a < b ||
			    (vertices[a].border && vertices[b].border && edge_is_open(work, a, b)))
				rc = push_edge(work, a, b);
		}
	return rc;
}

/* ---- validity of a collapse */

static void mark_neighbours(struct work *work, uint32_t vertex)
{
	work->mark++;
	EACH_CORNER(work, vertex, corner)
	{
		const uint32_t *triangle = work->surface->triangles[corner / 3];

		for (int i = 0; i < 3; i++)
			work->marks[triangle[i]] = work->mark;
	}
}

/* The link condition (Dey et al. 1999): the two ends have no common neighbours except those
 * opposite their edge. */
static bool link_is_sound(struct work *work, uint32_t a, uint32_t b)
{
	uint32_t across = 0, common = 0;

	mark_neighbours(work, a);
	EACH_CORNER(work, b, corner)
	{
		const uint32_t *triangle = work->surface->triangles[corner / 3];

		across += has(triangle, a);
		for (uint32_t i = 1; i < 3; i++) {
			uint32_t other = triangle[(corner % 3 + i) % 3];

			if (other == a || work->marks[other] != work->mark)
				continue;
			common++;
			work->marks[other] = work->mark - 1; /* count it once */
		}
	}
	return common <= across;
}

/* Returns true if after the collapse this triangle would coincide with one of the other end, facing
 * it. */
static bool is_cancelled(struct work *work, uint32_t corner, uint32_t other_end)
{
	const uint32_t *triangle = work->surface->triangles[corner / 3];
	uint32_t p = triangle[(corner % 3 + 1) % 3], q = triangle[(corner % 3 + 2) % 3];

	EACH_CORNER(work, other_end, facing)
	{
		const uint32_t *across = work->surface->triangles[facing / 3];

		if (across[(facing % 3 + 1) % 3] == q && across[(facing % 3 + 2) % 3] == p)
			return true;
	}
	return false;
}

/* Returns true if a triangle faces the same way as the scan did there, by the normals of its
 * corners. Small rotations add up over many collapses; this test does not drift. */
static bool faces_as_scan(const struct work *work, const uint32_t triangle[3],
			  const double normal[3])
{
	double sum = 0.0;

	for (int corner = 0; corner < 3; corner++)
		for (int i = 0; i < 3; i++)
			sum += normal[i] * work->surface->vertices[triangle[corner]].normal[i];
	return sum > 0.0;
}

/* Returns true if a triangle at vertex would turn over when the vertex moves to at. */
static bool folds(struct work *work, uint32_t vertex, uint32_t other_end, const double at[3])
{
	EACH_CORNER(work, vertex, corner)
	{
		const uint32_t *triangle = work->surface->triangles[corner / 3];
		double p[3], q[3], before[3], after[3], turned;

		if (has(triangle, other_end))
			continue;
		cross_of_triangle(before, work, corner / 3);
		place_of(p, work, triangle[(corner % 3 + 1) % 3]);
		place_of(q, work, triangle[(corner % 3 + 2) % 3]);
		cross_of(after, at, p, q);
		turned = dot(before, after);
		if (turned > 0.0 &&
		    turned * turned >
			    FOLD_COSINE * FOLD_COSINE * dot(before, before) * dot(after, after) &&
		    (faces_as_scan(work, triangle, after) ||
		     !faces_as_scan(work, triangle, before)))
			continue;
		if (dot(before, before) > 0.0 && !is_cancelled(work, corner, other_end))
			return true;
	}
	return false;
}

/* ---- the collapse */

static void blend(struct work *work, uint32_t keep, uint32_t gone)
{
	struct lattice_vertex *to = &work->surface->vertices[keep];
	const struct lattice_vertex *from = &work->surface->vertices[gone];
	double sum = work->areas[keep] + work->areas[gone];
	double share = sum > 0.0 ? work->areas[gone] / sum : 0.5;
	double normal[3], length;

	for (int i = 0; i < 4; i++)
		to->colour[i] =
			(uint8_t)(to->colour[i] + lrint(share * (from->colour[i] - to->colour[i])));
	to->seen = (uint8_t)(to->seen + lrint(share * (from->seen - to->seen)));
	for (int i = 0; i < 3; i++)
		normal[i] = (1.0 - share) * to->normal[i] + share * from->normal[i];
	length = sqrt(dot(normal, normal));
	for (int i = 0; i < 3 && length > 1e-6; i++)
		to->normal[i] = (float)(normal[i] / length);
}

static void kill(struct work *work, uint32_t t)
{
	work->dead[t] = 1;
	work->alive_count--;
}

/* Two triangles back to back enclose nothing: removes both. */
static void cancel_pairs(struct work *work, uint32_t vertex)
{
	EACH_CORNER(work, vertex, corner)
	{
		const uint32_t *triangle = work->surface->triangles[corner / 3];
		uint32_t p = triangle[(corner % 3 + 1) % 3], q = triangle[(corner % 3 + 2) % 3];

		for (uint32_t other = work->next[corner]; other != NONE;
		     other = work->next[other]) {
			const uint32_t *facing = work->surface->triangles[other / 3];

			if (work->dead[other / 3] || facing[(other % 3 + 1) % 3] != q ||
			    facing[(other % 3 + 2) % 3] != p)
				continue;
			if (work->alive_count <= 2)
				return; /* at least one triangle must stay */
			kill(work, corner / 3);
			kill(work, other / 3);
			break;
		}
	}
}

static void join_corners(struct work *work, uint32_t keep, uint32_t gone)
{
	uint32_t *end = &work->first[keep];

	EACH_CORNER(work, gone, corner)
	{
		if (has(work->surface->triangles[corner / 3], keep))
			kill(work, corner / 3);
		else
			work->surface->triangles[corner / 3][corner % 3] = keep;
	}
	while (*end != NONE)
		end = &work->next[*end];
	*end = work->first[gone];
	work->first[gone] = NONE;
}

static int push_edges_of(struct work *work, uint32_t vertex)
{
	work->mark++;
	EACH_CORNER(work, vertex, corner)
	{
		const uint32_t *triangle = work->surface->triangles[corner / 3];

		for (uint32_t i = 1; i < 3; i++) {
			uint32_t other = triangle[(corner % 3 + i) % 3];

			if (work->marks[other] == work->mark)
				continue;
			work->marks[other] = work->mark;
			if (push_edge(work, vertex, other) < 0)
				return -ENOMEM;
		}
	}
	return 0;
}

/* Returns true if the collapse would leave no triangle. */
static bool is_last(struct work *work, uint32_t a, uint32_t b)
{
	uint32_t forth;

	return work->alive_count <= triangles_at_edge(work, a, b, &forth) + 2;
}

static int collapse(struct work *work, const struct candidate *candidate)
{
	struct lattice_vertex *vertices = work->surface->vertices;
	uint32_t keep, gone;
	double at[3], value, weight;

	value = place_collapse(at, &keep, &gone, work, candidate->a, candidate->b);
	weight = work->quadrics[keep].weight + work->quadrics[gone].weight;
	if (value < 0.0 || value > weight * work->most || is_last(work, keep, gone) ||
	    (!work->loose && !link_is_sound(work, keep, gone)) || folds(work, gone, keep, at) ||
	    (!is_fixed(work, keep) && folds(work, keep, gone, at)))
		return 0;
	if (weight > 0.0 && value / weight > work->worst)
		work->worst = value / weight;
	work->loss = fmax(work->loss, value);
	if (!work->surface->locked[keep])
		blend(work, keep, gone);
	for (int i = 0; i < 3; i++)
		vertices[keep].position[i] = (int32_t)at[i];
	quadric_add(&work->quadrics[keep], &work->quadrics[gone]);
	work->areas[keep] += work->areas[gone];
	join_corners(work, keep, gone);
	cancel_pairs(work, keep);
	work->versions[keep]++;
	work->versions[gone]++;
	work->collapse_count++;
	return push_edges_of(work, keep);
}

static int collapse_until(struct work *work, uint32_t target)
{
	int rc = push_all_edges(work);

	while (rc == 0 && work->alive_count > target && work->heap_count > 0) {
		struct candidate least = pop(work);

		if (work->first[least.a] != NONE && work->first[least.b] != NONE &&
		    least.stamp == work->versions[least.a] + work->versions[least.b])
			rc = collapse(work, &least);
	}
	return rc;
}

static int work_init(struct work *work, struct simplify_surface *surface)
{
	size_t vertices = (size_t)surface->vertex_count + 1;
	size_t triangles = (size_t)surface->triangle_count + 1;

	*work = (struct work){
		.surface = surface,
		.quadrics = calloc(vertices, sizeof(*work->quadrics)),
		.areas = calloc(vertices, sizeof(*work->areas)),
		.first = malloc(vertices * sizeof(*work->first)),
		.next = malloc(3 * triangles * sizeof(*work->next)),
		.dead = calloc(triangles, sizeof(*work->dead)),
		.versions = calloc(vertices, sizeof(*work->versions)),
		.marks = calloc(vertices, sizeof(*work->marks)),
		.alive_count = surface->triangle_count,
	};
	if (!work->quadrics || !work->areas || !work->first || !work->next || !work->dead ||
	    !work->versions || !work->marks ||
	    ARRAY_RESERVE(work->heap, work->heap_room, 5 * triangles, UINT32_MAX) < 0)
		return -ENOMEM;
	memset(work->first, 0xff, vertices * sizeof(*work->first));
	for (uint32_t corner = 0; corner < 3 * surface->triangle_count; corner++) {
		uint32_t vertex = surface->triangles[corner / 3][corner % 3];

		work->next[corner] = work->first[vertex];
		work->first[vertex] = corner;
	}
	for (uint32_t t = 0; t < surface->triangle_count; t++)
		add_triangle(work, t);
	return 0;
}

static void work_finish(struct work *work)
{
	free(work->quadrics);
	free(work->areas);
	free(work->first);
	free(work->next);
	free(work->dead);
	free(work->versions);
	free(work->marks);
	free(work->heap);
}

int simplify(struct simplify_surface *surface, uint32_t target_triangles, double error_most_steps,
	     struct simplify_result *result)
{
	struct work work;
	uint32_t kept = 0, before;
	int rc = work_init(&work, surface);

	*result = (struct simplify_result){ 0 };
	work.most = error_most_steps * error_most_steps;
	if (rc == 0)
		rc = collapse_until(&work, target_triangles);
	/* If it is stuck, the topology of the surface is the obstacle. Let the surface pinch, as
	 * long as that helps. */
	work.loose = true;
	do {
		before = work.alive_count;
		if (rc == 0 && before > target_triangles)
			rc = collapse_until(&work, target_triangles);
	} while (rc == 0 && work.alive_count > target_triangles &&
		 work.alive_count < before - before / 16);
	for (uint32_t t = 0; rc == 0 && t < surface->triangle_count; t++)
		if (!work.dead[t])
			memmove(surface->triangles[kept++], surface->triangles[t],
				sizeof(*surface->triangles));
	if (rc == 0) {
		surface->triangle_count = kept;
		result->error_steps = sqrt(work.worst);
		result->loss_steps4 = work.loss;
		result->collapse_count = work.collapse_count;
	}
	work_finish(&work);
	return rc;
}
