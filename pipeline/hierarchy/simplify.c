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

/* What is asked of a vertex, in two lines of the cache. */
struct node {
	struct quadric quadric;
	double at[3];      /* its position */
	double area;       /* to average normals and colours */
	double importance; /* of what is seen of it */
	uint32_t first;    /* its first corner, or NONE */
	uint32_t version;
	uint32_t mark;
	uint8_t locked, border;
};

/* Corner 4 t + i is corner i of triangle t. The corners at a vertex are a linked list. */
struct face {
	uint32_t corners[3];
	uint32_t next[3];
	bool dead;
};

struct candidate {
	uint32_t a, b;
	uint32_t stamp; /* sum of both vertices' versions; they only increase */
};

/* Costs are not negative, so their bits are in the order of their values. */
struct entry {
	uint32_t candidate, cost;
};

struct work {
	struct simplify_surface *surface;
	struct node *nodes; /* for each vertex */
	struct face *faces; /* for each triangle */
	uint32_t mark;
	struct candidate *candidates; /* all that were ever in the heap */
	struct entry *heap;
	uint32_t candidate_count, candidate_room, heap_count, heap_room;
	uint32_t alive_count;
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

/* ---- the surface */

static uint32_t *corners_of(const struct work *work, uint32_t corner)
{
	return work->faces[corner / 4].corners;
}

/* The corners of its triangle that follow a corner. */
static uint32_t after(const struct work *work, uint32_t corner)
{
	static const uint8_t next[4] = { 1, 2, 0, 0 };

	return corners_of(work, corner)[next[corner % 4]];
}

static uint32_t before(const struct work *work, uint32_t corner)
{
	static const uint8_t next[4] = { 2, 0, 1, 0 };

	return corners_of(work, corner)[next[corner % 4]];
}

static uint32_t *next_of(const struct work *work, uint32_t corner)
{
	return &work->faces[corner / 4].next[corner % 4];
}

/* Returns the next living corner at a vertex, and unlinks dead ones on the way. */
static uint32_t living(const struct work *work, uint32_t *link)
{
	while (*link != NONE && work->faces[*link / 4].dead)
		*link = *next_of(work, *link);
	return *link;
}

#define EACH_CORNER(work, vertex, corner)                                                          \
	for (uint32_t *link_##corner = &(work)->nodes[vertex].first, corner;                       \
	     (corner = living(work, link_##corner)) != NONE;                                       \
	     link_##corner = next_of(work, corner))

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

static void cross_of_triangle(double out[3], const struct work *work, const uint32_t corners[3])
{
	cross_of(out, work->nodes[corners[0]].at, work->nodes[corners[1]].at,
		 work->nodes[corners[2]].at);
}

/* Counts the triangles at an edge; *forth is how many of them run from a to b. */
static uint32_t triangles_at_edge(struct work *work, uint32_t a, uint32_t b, uint32_t *forth)
{
	uint32_t count = 0;

	*forth = 0;
	EACH_CORNER(work, a, corner)
	{
		count += after(work, corner) == b || before(work, corner) == b;
		*forth += after(work, corner) == b;
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
	const double *at = work->nodes[a].at;
	double along[3], side[3], length;

	for (int i = 0; i < 3; i++)
		along[i] = work->nodes[b].at[i] - at[i];
	for (int i = 0; i < 3; i++)
		side[i] = along[(i + 1) % 3] * normal[(i + 2) % 3] -
			  along[(i + 2) % 3] * normal[(i + 1) % 3];
	length = sqrt(dot(side, side));
	if (length <= 0.0)
		return;
	for (int i = 0; i < 3; i++)
		side[i] /= length;
	weight *= BORDER_WEIGHT * dot(along, along);
	quadric_add_plane(&work->nodes[a].quadric, side, at, weight);
	quadric_add_plane(&work->nodes[b].quadric, side, at, weight);
}

static void add_triangle(struct work *work, uint32_t t)
{
	const uint32_t *corners = work->faces[t].corners;
	double normal[3], length, weight = 0.0;

	cross_of_triangle(normal, work, corners);
	length = sqrt(dot(normal, normal));
	if (length <= 0.0)
		return;
	for (int i = 0; i < 3; i++)
		normal[i] /= length;
	for (int corner = 0; corner < 3; corner++)
		weight += work->nodes[corners[corner]].importance / 3.0;
	for (int corner = 0; corner < 3; corner++) {
		uint32_t a = corners[corner], b = corners[(corner + 1) % 3];
		struct node *node = &work->nodes[a];

		quadric_add_plane(&node->quadric, normal, work->nodes[corners[0]].at,
				  weight * length / 6.0);
		node->area += length / 6.0;
		if (node->border && work->nodes[b].border && edge_is_open(work, a, b))
			add_open_edge(work, a, b, normal, weight);
	}
}

/* ---- cost of a collapse */

/* Returns true if gone may be removed while keep stays. Open edges are only shortened along
 * themselves. */
static bool may_leave(const struct node *gone, const struct node *keep, bool open)
{
	return !gone->locked && (!gone->border || (keep->border && open));
}

static bool is_fixed(const struct node *node)
{
	return node->locked || node->border;
}

static void round_to_lattice(double at[3], uint8_t fine_bits)
{
	const double last = (1 << (LATTICE_BITS + fine_bits)) - 1;

	for (int i = 0; i < 3; i++) {
		double steps = (at[i] > 0.0 ? at[i] : 0.0) + 0.5;

		at[i] = (int)(steps < last ? steps : last);
	}
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
	const struct node *node_a = &work->nodes[a], *node_b = &work->nodes[b];
	bool open = node_a->border && node_b->border && edge_is_open(work, a, b);
	bool a_may = may_leave(node_a, node_b, open), b_may = may_leave(node_b, node_a, open);
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
		return free_place(out, &sum, node_a->at, node_b->at, work->surface->fine_bits);
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
	memcpy(out, work->nodes[*keep].at, sizeof(node_a->at));
	return value_b < value_a ? value_b : value_a;
}

static double colour_distance(const struct work *work, uint32_t a, uint32_t b)
{
	const uint8_t *from = work->surface->vertices[a].colour;
	const uint8_t *to = work->surface->vertices[b].colour;
	double sum = 0.0;

	for (int i = 0; i < 3; i++)
		sum += work->colour_squares[abs(from[i] - to[i])];
	return sum;
}

static int push_edge(struct work *work, uint32_t a, uint32_t b)
{
	const struct node *node_a = &work->nodes[a], *node_b = &work->nodes[b];
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
	for (uint32_t t = 0; rc == 0 && t < work->surface->triangle_count; t++)
		for (int corner = 0; rc == 0 && !work->faces[t].dead && corner < 3; corner++) {
			uint32_t a = work->faces[t].corners[corner];
			uint32_t b = work->faces[t].corners[(corner + 1) % 3];

			if (a < b || (work->nodes[a].border && work->nodes[b].border &&
				      edge_is_open(work, a, b)))
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
		for (int i = 0; i < 3; i++)
			work->nodes[corners_of(work, corner)[i]].mark = work->mark;
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
		const uint32_t others[2] = { after(work, corner), before(work, corner) };

		across += others[0] == a || others[1] == a;
		for (int i = 0; i < 2; i++) {
			struct node *other = &work->nodes[others[i]];

			if (others[i] == a || other->mark != work->mark)
				continue;
			common++;
			other->mark = work->mark - 1; /* count it once */
		}
	}
	return common <= across;
}

/* Returns true if after the collapse this triangle would coincide with one of the other end, facing
 * it. */
static bool is_cancelled(struct work *work, uint32_t corner, uint32_t other_end)
{
	uint32_t p = after(work, corner), q = before(work, corner);

	EACH_CORNER(work, other_end, facing)
	{
		if (after(work, facing) == q && before(work, facing) == p)
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
		const uint32_t *triangle = corners_of(work, corner);
		uint32_t p = after(work, corner), q = before(work, corner);
		double was[3], becomes[3], turned, square;

		if (p == other_end || q == other_end)
			continue;
		cross_of_triangle(was, work, triangle);
		cross_of(becomes, at, work->nodes[p].at, work->nodes[q].at);
		turned = dot(was, becomes);
		square = dot(was, was);
		if (turned > 0.0 &&
		    turned * turned > FOLD_COSINE * FOLD_COSINE * square * dot(becomes, becomes) &&
		    (faces_as_scan(work, triangle, becomes) || !faces_as_scan(work, triangle, was)))
			continue;
		if (square > 0.0 && !is_cancelled(work, corner, other_end))
			return true;
	}
	return false;
}

/* ---- the collapse */

static void blend(struct work *work, uint32_t keep, uint32_t gone)
{
	struct lattice_vertex *to = &work->surface->vertices[keep];
	const struct lattice_vertex *from = &work->surface->vertices[gone];
	double sum = work->nodes[keep].area + work->nodes[gone].area;
	double share = sum > 0.0 ? work->nodes[gone].area / sum : 0.5;
	double normal[3], length;

	for (int i = 0; i < 4; i++)
		to->colour[i] =
			(uint8_t)(to->colour[i] + lrint(share * (from->colour[i] - to->colour[i])));
	to->seen = (uint8_t)(to->seen + lrint(share * (from->seen - to->seen)));
	work->nodes[keep].importance = importance(to);
	for (int i = 0; i < 3; i++)
		normal[i] = (1.0 - share) * to->normal[i] + share * from->normal[i];
	length = sqrt(dot(normal, normal));
	for (int i = 0; i < 3 && length > 1e-6; i++)
		to->normal[i] = (float)(normal[i] / length);
}

static void kill(struct work *work, uint32_t corner)
{
	work->faces[corner / 4].dead = true;
	work->alive_count--;
}

/* Two triangles back to back enclose nothing: removes both. */
static void cancel_pairs(struct work *work, uint32_t vertex)
{
	EACH_CORNER(work, vertex, corner)
	{
		uint32_t p = after(work, corner), q = before(work, corner);

		for (uint32_t other = *next_of(work, corner); other != NONE;
		     other = *next_of(work, other)) {
			if (after(work, other) != q || before(work, other) != p ||
			    work->faces[other / 4].dead)
				continue;
			if (work->alive_count <= 2)
				return; /* at least one triangle must stay */
			kill(work, corner);
			kill(work, other);
			break;
		}
	}
}

static void join_corners(struct work *work, uint32_t keep, uint32_t gone)
{
	uint32_t *end = &work->nodes[keep].first;

	EACH_CORNER(work, gone, corner)
	{
		if (after(work, corner) == keep || before(work, corner) == keep)
			kill(work, corner);
		else
			corners_of(work, corner)[corner % 4] = keep;
	}
	while (*end != NONE)
		end = next_of(work, *end);
	*end = work->nodes[gone].first;
	work->nodes[gone].first = NONE;
}

static int push_edges_of(struct work *work, uint32_t vertex)
{
	work->mark++;
	EACH_CORNER(work, vertex, corner)
	{
		const uint32_t others[2] = { after(work, corner), before(work, corner) };

		for (int i = 0; i < 2; i++) {
			struct node *other = &work->nodes[others[i]];

			if (other->mark == work->mark)
				continue;
			other->mark = work->mark;
			if (push_edge(work, vertex, others[i]) < 0)
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
	struct node *kept, *left;
	uint32_t keep, gone;
	double at[3], value, weight;

	value = place_collapse(at, &keep, &gone, work, candidate->a, candidate->b);
	kept = &work->nodes[keep];
	left = &work->nodes[gone];
	weight = kept->quadric.weight + left->quadric.weight;
	if (value < 0.0 || value > weight * work->most || is_last(work, keep, gone) ||
	    (!work->loose && !link_is_sound(work, keep, gone)) || folds(work, gone, keep, at) ||
	    (!is_fixed(kept) && folds(work, keep, gone, at)))
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
	quadric_add(&kept->quadric, &left->quadric);
	kept->area += left->area;
	join_corners(work, keep, gone);
	cancel_pairs(work, keep);
	kept->version++;
	left->version++;
	work->collapse_count++;
	return push_edges_of(work, keep);
}

static int collapse_until(struct work *work, uint32_t target)
{
	int rc = push_all_edges(work);

	while (rc == 0 && work->alive_count > target && work->heap_count > 0) {
		struct candidate least = pop(work);
		const struct node *a = &work->nodes[least.a], *b = &work->nodes[least.b];

		if (a->first != NONE && b->first != NONE && least.stamp == a->version + b->version)
			rc = collapse(work, &least);
	}
	return rc;
}

static void node_init(struct node *node, const struct lattice_vertex *vertex, uint8_t locked)
{
	*node = (struct node){
		.importance = importance(vertex),
		.first = NONE,
		.locked = locked,
		.border = vertex->border,
	};
	for (int i = 0; i < 3; i++)
		node->at[i] = vertex->position[i];
}

static int work_init(struct work *work, struct simplify_surface *surface)
{
	size_t vertices = (size_t)surface->vertex_count + 1;
	size_t triangles = (size_t)surface->triangle_count + 1;

	*work = (struct work){
		.surface = surface,
		.nodes = malloc(vertices * sizeof(*work->nodes)),
		.faces = malloc(triangles * sizeof(*work->faces)),
		.alive_count = surface->triangle_count,
	};
	if (!work->nodes || !work->faces ||
	    ARRAY_RESERVE(work->heap, work->heap_room, 5 * triangles, UINT32_MAX) < 0 ||
	    ARRAY_RESERVE(work->candidates, work->candidate_room, 5 * triangles, UINT32_MAX) < 0)
		return -ENOMEM;
	for (uint32_t i = 0; i < ARRAY_COUNT(work->colour_squares); i++)
		work->colour_squares[i] = i / 255.0 * (i / 255.0) / 3.0;
	for (uint32_t v = 0; v < surface->vertex_count; v++)
		node_init(&work->nodes[v], &surface->vertices[v], surface->locked[v]);
	for (uint32_t t = 0; t < surface->triangle_count; t++) {
		struct face *face = &work->faces[t];

		face->dead = false;
		for (uint32_t i = 0; i < 3; i++) {
			struct node *node = &work->nodes[surface->triangles[t][i]];

			face->corners[i] = surface->triangles[t][i];
			face->next[i] = node->first;
			node->first = 4 * t + i;
		}
	}
	for (uint32_t t = 0; t < surface->triangle_count; t++)
		add_triangle(work, t);
	return 0;
}

static void work_finish(struct work *work)
{
	free(work->nodes);
	free(work->faces);
	free(work->candidates);
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
		if (!work.faces[t].dead)
			memcpy(surface->triangles[kept++], work.faces[t].corners,
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
