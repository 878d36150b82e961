/* Half-edge collapses in rounds, with link condition and fold-over check (paper P3, section 3.5).
 */
#include "pipeline/hierarchy/stream_collapse.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "pipeline/hierarchy/quadric.h"

enum { SHARE = 6 /* a round removes at most one in so many vertices */ };
/* A triangle may turn by about 75 degrees in one collapse. */
#define TURN_COS 0.25

struct choice {
	double cost;
	uint32_t gone, target; /* target STREAM_NONE: its piece vanishes */
};

struct work {
	struct stream_collapses *out;
	const struct patch_vertex *vertices;
	uint32_t vertex_count;
	uint32_t (*triangles)[3];
	uint32_t *first, *next; /* owned; lists of corners, as in format/stream_mesh.h */
	struct quadric *quadrics;
	uint8_t *dead, *locked;
	struct choice *choices;
	uint32_t alive, choice_count, round;
};

/* Neighbours of a vertex, each with the number of its triangles at the edge. */
struct link {
	uint32_t count, vertices[4 * STREAM_RING_MAX], triangles[4 * STREAM_RING_MAX];
	uint32_t degree, special; /* edges that have not two triangles */
};

static void position_of(double out[3], const struct work *work, uint32_t vertex)
{
	for (int i = 0; i < 3; i++)
		out[i] = work->vertices[vertex].position[i];
}

static double cross_of(double out[3], const double a[3], const double b[3], const double c[3])
{
	double u[3], v[3];

	for (int i = 0; i < 3; i++) {
		u[i] = b[i] - a[i];
		v[i] = c[i] - a[i];
	}
	for (int i = 0; i < 3; i++)
		out[i] = u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
	return sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]);
}

static bool get_link(struct link *link, const struct work *work, uint32_t vertex)
{
	link->count = link->degree = link->special = 0;
	for (uint32_t at = work->first[vertex]; at != STREAM_NONE; at = work->next[at]) {
		if (++link->degree > STREAM_RING_MAX)
			return false;
		for (uint32_t turn = 1; turn < 3; turn++) {
			uint32_t x = work->triangles[at / 3][(at % 3 + turn) % 3], i = 0;

			while (i < link->count && link->vertices[i] != x)
				i++;
			if (i == link->count) {
				link->vertices[link->count] = x;
				link->triangles[link->count++] = 0;
			}
			link->triangles[i]++;
		}
	}
	for (uint32_t i = 0; i < link->count; i++)
		link->special += link->triangles[i] != 2;
	return true;
}

static uint32_t find_in(const struct link *link, uint32_t vertex)
{
	for (uint32_t i = 0; i < link->count; i++)
		if (link->vertices[i] == vertex)
			return i;
	return STREAM_NONE;
}

/* No common neighbour but the third corners of the edge's triangles, which must keep another
 * triangle at the target; and no edge opposite to both. */
static bool link_condition(const struct work *work, uint32_t gone, uint32_t target,
			   const struct link *gone_link, const struct link *target_link,
			   uint32_t at_edge)
{
	uint32_t common = 0, thirds = 0;

	for (uint32_t i = 0; i < gone_link->count; i++)
		common += find_in(target_link, gone_link->vertices[i]) != STREAM_NONE;
	for (uint32_t at = work->first[gone]; at != STREAM_NONE; at = work->next[at]) {
		uint32_t next = work->triangles[at / 3][(at % 3 + 1) % 3];
		uint32_t before = work->triangles[at / 3][(at % 3 + 2) % 3], x, g, t;

		if (next == target || before == target) {
			x = next == target ? before : next;
			g = find_in(gone_link, x);
			t = find_in(target_link, x);
			if (gone_link->triangles[g] + target_link->triangles[t] < 3)
				return false;
			thirds++;
			continue;
		}
		for (uint32_t to = work->first[target]; to != STREAM_NONE; to = work->next[to]) {
			uint32_t n = work->triangles[to / 3][(to % 3 + 1) % 3];
			uint32_t b = work->triangles[to / 3][(to % 3 + 2) % 3];

			if ((n == next && b == before) || (n == before && b == next))
				return false;
		}
	}
	return thirds == at_edge && common == thirds;
}

static bool folds(const struct work *work, uint32_t gone, uint32_t target)
{
	double to[3];

	position_of(to, work, target);
	for (uint32_t at = work->first[gone]; at != STREAM_NONE; at = work->next[at]) {
		uint32_t next = work->triangles[at / 3][(at % 3 + 1) % 3];
		uint32_t before = work->triangles[at / 3][(at % 3 + 2) % 3];
		double a[3], b[3], c[3], old[3], new[3], old_length, new_length;

		if (next == target || before == target)
			continue;
		position_of(a, work, gone);
		position_of(b, work, next);
		position_of(c, work, before);
		old_length = cross_of(old, a, b, c);
		new_length = cross_of(new, to, b, c);
		if (old_length == 0.0)
			continue;
		if (new_length == 0.0 || old[0] * new[0] + old[1] * new[1] + old[2] * new[2] <
						 TURN_COS * old_length *new_length)
			return true;
	}
	return false;
}

/* Returns whether the collapse is allowed. */
static bool allowed(const struct work *work, uint32_t gone, uint32_t target,
		    const struct link *gone_link)
{
	struct link target_link;
	uint32_t at_edge = gone_link->triangles[find_in(gone_link, target)];

	if (at_edge > STREAM_FACES_MAX || !get_link(&target_link, work, target) ||
	    target_link.degree + gone_link->degree - 2 * at_edge > STREAM_RING_MAX)
		return false;
	/* A vertex of a border, or of an edge with three triangles, moves along it. */
	if (gone_link->special && (gone_link->special != 2 || at_edge == 2))
		return false;
	return link_condition(work, gone, target, gone_link, &target_link, at_edge) &&
	       !folds(work, gone, target);
}

/* ---- loose pieces */

/* Sets out to the vertices of a piece of three or four; 0: it is larger. */
static uint32_t piece_of(uint32_t out[STREAM_PIECE_VERTICES], const struct work *work,
			 uint32_t vertex)
{
	uint32_t count = 1;

	out[0] = vertex;
	for (uint32_t v = 0; v < count; v++)
		for (uint32_t at = work->first[out[v]]; at != STREAM_NONE; at = work->next[at])
			for (uint32_t c = 0; c < 3; c++) {
				uint32_t x = work->triangles[at / 3][c], i = 0;

				while (i < count && out[i] != x)
					i++;
				if (i < count)
					continue;
				if (count == STREAM_PIECE_VERTICES)
					return 0;
				out[count++] = x;
			}
	return count < 3 ? 0 : count;
}

/* Returns whether no triangle of a piece is there twice, which no record expresses. */
static bool piece_is_plain(const struct work *work, const uint32_t *piece, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++)
		for (uint32_t at = work->first[piece[i]]; at != STREAM_NONE; at = work->next[at])
			for (uint32_t to = work->next[at]; to != STREAM_NONE; to = work->next[to])
				if (work->triangles[at / 3][(at % 3 + 1) % 3] ==
					    work->triangles[to / 3][(to % 3 + 1) % 3] &&
				    work->triangles[at / 3][(at % 3 + 2) % 3] ==
					    work->triangles[to / 3][(to % 3 + 2) % 3])
					return false;
	return true;
}

static double piece_cost(const struct work *work, const uint32_t *piece, uint32_t count)
{
	double largest = 0.0;

	for (uint32_t i = 1; i < count; i++) {
		double a[3], b[3], square = 0.0;

		position_of(a, work, piece[0]);
		position_of(b, work, piece[i]);
		for (int k = 0; k < 3; k++)
			square += (a[k] - b[k]) * (a[k] - b[k]);
		largest = square > largest ? square : largest;
	}
	return largest * largest; /* area times squared distance */
}

/* ---- rounds */

static void choose(struct work *work, uint32_t vertex)
{
	struct choice best = { INFINITY, vertex, STREAM_NONE };
	uint32_t piece[STREAM_PIECE_VERTICES], count;
	struct link link;

	if (work->dead[vertex] || work->first[vertex] == STREAM_NONE)
		return;
	count = piece_of(piece, work, vertex);
	if (count) {
		best.cost = piece_cost(work, piece, count);
		for (uint32_t i = 1; i < count; i++)
			if (piece[i] < vertex)
				return; /* the piece is its lowest vertex' */
		if (!piece_is_plain(work, piece, count))
			return;
		work->choices[work->choice_count++] = best;
		return;
	}
	if (!get_link(&link, work, vertex))
		return;
	for (uint32_t i = 0; i < link.count; i++) {
		double to[3], cost;

		position_of(to, work, link.vertices[i]);
		cost = quadric_at(&work->quadrics[vertex], to);
		if (cost < best.cost && allowed(work, vertex, link.vertices[i], &link)) {
			best.cost = cost;
			best.target = link.vertices[i];
		}
	}
	if (best.target != STREAM_NONE)
		work->choices[work->choice_count++] = best;
}

static int compare_choices(const void *a, const void *b)
{
	const struct choice *x = a, *y = b;

	if (x->cost != y->cost)
		return x->cost < y->cost ? -1 : 1;
	return x->gone < y->gone ? -1 : x->gone > y->gone;
}

static bool star_free(const struct work *work, uint32_t vertex)
{
	for (uint32_t at = work->first[vertex]; at != STREAM_NONE; at = work->next[at])
		for (uint32_t c = 0; c < 3; c++)
			if (work->locked[work->triangles[at / 3][c]])
				return false;
	return true;
}

static void lock_star(struct work *work, uint32_t vertex)
{
	for (uint32_t at = work->first[vertex]; at != STREAM_NONE; at = work->next[at])
		for (uint32_t c = 0; c < 3; c++)
			work->locked[work->triangles[at / 3][c]] = 1;
}

static void unlink_corner(struct work *work, uint32_t corner)
{
	uint32_t *at = &work->first[work->triangles[corner / 3][corner % 3]];

	while (*at != corner)
		at = &work->next[*at];
	*at = work->next[corner];
}

static int list_add(struct stream_collapses *out, uint32_t number)
{
	int rc = ARRAY_RESERVE(out->lists, out->list_room, out->list_count + 1, UINT32_MAX / 2);

	if (rc == 0)
		out->lists[out->list_count++] = number;
	return rc;
}

static int drop_triangle(struct work *work, uint32_t triangle)
{
	int rc = list_add(work->out, triangle);

	for (uint32_t c = 0; c < 3; c++) {
		unlink_corner(work, 3 * triangle + c);
		if (rc == 0)
			rc = list_add(work->out, work->triangles[triangle][c]);
	}
	memset(work->triangles[triangle], 0xff, sizeof(*work->triangles));
	return rc;
}

static int collapse(struct work *work, const struct choice *choice)
{
	struct stream_collapses *out = work->out;
	struct stream_collapse item = { .target = choice->target,
					.gone = choice->gone,
					.round = work->round };
	uint32_t vanished[4 * STREAM_RING_MAX], at, next;
	int rc = ARRAY_RESERVE(out->items, out->room, out->count + 1, STREAM_VERTICES_MAX);

	item.first = out->list_count;
	for (at = work->first[choice->gone]; rc == 0 && at != STREAM_NONE; at = next) {
		uint32_t *corners = work->triangles[at / 3];

		next = work->next[at];
		if (corners[0] == choice->target || corners[1] == choice->target ||
		    corners[2] == choice->target) {
			vanished[item.vanished_count++] = at / 3;
			continue;
		}
		rc = list_add(out, at / 3);
		item.moved_count++;
		unlink_corner(work, at);
		corners[at % 3] = choice->target;
		work->next[at] = work->first[choice->target];
		work->first[choice->target] = at;
	}
	for (uint32_t i = 0; rc == 0 && i < item.vanished_count; i++)
		rc = drop_triangle(work, vanished[i]);
	if (rc < 0)
		return rc;
	quadric_add(&work->quadrics[choice->target], &work->quadrics[choice->gone]);
	work->dead[choice->gone] = 1;
	work->alive--;
	out->items[out->count++] = item;
	return 0;
}

static int vanish(struct work *work, uint32_t vertex)
{
	struct stream_collapses *out = work->out;
	struct stream_collapse item = { .target = STREAM_NONE,
					.gone = vertex,
					.round = work->round };
	uint32_t count;
	int rc = ARRAY_RESERVE(out->items, out->room, out->count + 1, STREAM_VERTICES_MAX);

	memset(item.piece, 0xff, sizeof(item.piece));
	item.first = out->list_count;
	count = piece_of(item.piece, work, vertex);
	for (uint32_t i = count; i < STREAM_PIECE_VERTICES; i++)
		item.piece[i] = STREAM_NONE;
	for (uint32_t i = 0; rc == 0 && i < count; i++) {
		while (rc == 0 && work->first[item.piece[i]] != STREAM_NONE) {
			rc = drop_triangle(work, work->first[item.piece[i]] / 3);
			item.vanished_count++;
		}
		work->dead[item.piece[i]] = 1;
	}
	if (rc < 0)
		return rc;
	work->alive -= count;
	out->items[out->count++] = item;
	return 0;
}

/* Returns the number of collapses, or an error. */
static int do_round(struct work *work)
{
	uint32_t most = work->alive / SHARE + 1, count = 0;
	int rc = 0;

	work->choice_count = 0;
	work->round++;
	memset(work->locked, 0, work->vertex_count);
	for (uint32_t v = 0; v < work->vertex_count; v++)
		choose(work, v);
	qsort(work->choices, work->choice_count, sizeof(*work->choices), compare_choices);
	for (uint32_t i = 0; rc == 0 && i < work->choice_count && count < most; i++) {
		if (work->alive <= STREAM_BASE_VERTICES)
			break;
		const struct choice *choice = &work->choices[i];

		if (!star_free(work, choice->gone) ||
		    (choice->target != STREAM_NONE && !star_free(work, choice->target)))
			continue;
		lock_star(work, choice->gone);
		if (choice->target != STREAM_NONE)
			lock_star(work, choice->target);
		rc = choice->target == STREAM_NONE ? vanish(work, choice->gone)
						   : collapse(work, choice);
		count++;
	}
	return rc < 0 ? rc : (int)count;
}

static void fill(struct work *work, uint32_t triangle_count)
{
	memset(work->first, 0xff, (work->vertex_count + 1) * sizeof(*work->first));
	for (uint32_t t = 0; t < triangle_count; t++) {
		double a[3], b[3], c[3], normal[3], length;

		position_of(a, work, work->triangles[t][0]);
		position_of(b, work, work->triangles[t][1]);
		position_of(c, work, work->triangles[t][2]);
		length = cross_of(normal, a, b, c);
		for (int i = 0; i < 3 && length > 0.0; i++)
			normal[i] /= length;
		for (uint32_t k = 0; k < 3; k++) {
			uint32_t v = work->triangles[t][k];

			work->next[3 * t + k] = work->first[v];
			work->first[v] = 3 * t + k;
			if (length > 0.0)
				quadric_add_plane(&work->quadrics[v], normal, a, length / 2);
		}
	}
}

int stream_collapse(struct stream_collapses *out, const struct patch_vertex *vertices,
		    uint32_t vertex_count, uint32_t (*triangles)[3], uint32_t triangle_count)
{
	struct work work = { .out = out,
			     .vertices = vertices,
			     .vertex_count = vertex_count,
			     .triangles = triangles,
			     .alive = vertex_count };
	size_t room = (size_t)vertex_count + 1;
	int rc = -ENOMEM;

	*out = (struct stream_collapses){ 0 };
	work.first = malloc(room * sizeof(*work.first));
	work.next = malloc((triangle_count + (size_t)1) * 3 * sizeof(*work.next));
	work.quadrics = calloc(room, sizeof(*work.quadrics));
	work.dead = calloc(room, 1);
	work.locked = calloc(room, 1);
	work.choices = malloc(room * sizeof(*work.choices));
	if (work.first && work.next && work.quadrics && work.dead && work.locked && work.choices) {
		fill(&work, triangle_count);
		do
			rc = do_round(&work);
		while (rc > 0);
	}
	free(work.first);
	free(work.next);
	free(work.quadrics);
	free(work.dead);
	free(work.locked);
	free(work.choices);
	if (rc < 0)
		stream_collapses_finish(out);
	return rc;
}

void stream_collapses_finish(struct stream_collapses *collapses)
{
	free(collapses->items);
	free(collapses->lists);
	*collapses = (struct stream_collapses){ 0 };
}
