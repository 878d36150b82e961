/* Half-edge collapses in rounds, with link condition and fold-over check (paper P3, section 3.5).
 */
#include "pipeline/hierarchy/stream_collapse.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "pipeline/hierarchy/collapse.h"

enum { SHARE = 6 /* a round removes at most one in so many vertices */ };
/* A triangle that turns by more than about 75 degrees in one collapse counts as folded over. */
#define TURN_COS 0.25
/* What the checks of section 3.5 refuse costs so many times more where it is possible: such a
 * collapse waits until nothing better is left. Without them, loose pieces of more than four
 * vertices never become smaller. */
#define LEAVES_FACTOR 4.0
#define FOLDS_FACTOR  16.0

struct choice {
	double cost;
	uint32_t gone, target; /* target STREAM_NONE: its piece vanishes */
};

struct work {
	const struct stream_options *options;
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

/* Sets out to the normal of a triangle, and returns its length: twice the area. */
static double cross_of(double out[3], const double a[3], const double b[3], const double c[3])
{
	collapse_cross(out, a, b, c);
	return sqrt(collapse_dot(out, out));
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

/* Returns how many triangles run from a to b to c. */
static uint32_t count_runs(const struct work *work, uint32_t a, uint32_t b, uint32_t c)
{
	uint32_t count = 0;

	for (uint32_t at = work->first[a]; at != STREAM_NONE; at = work->next[at]) {
		uint32_t next = work->triangles[at / 3][(at % 3 + 1) % 3];
		uint32_t before = work->triangles[at / 3][(at % 3 + 2) % 3];

		count += next == b && before == c;
	}
	return count;
}

enum link_state { LINK_BROKEN, LINK_PINCHED, LINK_HOLDS };

/* The link condition: no common neighbour but the third corners of the edge's triangles; otherwise
 * the surface is pinched. Broken, so that no record can express it: a third corner keeps no other
 * triangle at the target, a triangle is there twice, or there is an edge opposite to both. */
static enum link_state link_condition(const struct work *work, uint32_t gone, uint32_t target,
				      const struct link *gone_link, const struct link *target_link,
				      uint32_t at_edge)
{
	uint32_t common = 0, thirds = 0, there, back;

	for (uint32_t i = 0; i < gone_link->count; i++)
		common += find_in(target_link, gone_link->vertices[i]) != STREAM_NONE;
	for (uint32_t at = work->first[gone]; at != STREAM_NONE; at = work->next[at]) {
		uint32_t next = work->triangles[at / 3][(at % 3 + 1) % 3];
		uint32_t before = work->triangles[at / 3][(at % 3 + 2) % 3], x, g, t;

		if (next == target || before == target) {
			x = next == target ? before : next;
			g = find_in(gone_link, x);
			t = find_in(target_link, x);
			there = count_runs(work, gone, target, x);
			back = count_runs(work, gone, x, target);
			if (there > 1 || back > 1 ||
			    gone_link->triangles[g] + target_link->triangles[t] <
				    2 * (there + back) + 1)
				return LINK_BROKEN;
			thirds++;
			continue;
		}
		for (uint32_t to = work->first[target]; to != STREAM_NONE; to = work->next[to]) {
			uint32_t n = work->triangles[to / 3][(to % 3 + 1) % 3];
			uint32_t b = work->triangles[to / 3][(to % 3 + 2) % 3];

			if ((n == next && b == before) || (n == before && b == next))
				return LINK_BROKEN;
		}
	}
	if (thirds != at_edge)
		return LINK_BROKEN;
	return common == thirds ? LINK_HOLDS : LINK_PINCHED;
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
		if (new_length == 0.0 ||
		    collapse_dot(old, new) < TURN_COS * old_length * new_length)
			return true;
	}
	return false;
}

/* Returns the factor of the cost; 0: the collapse is not possible. */
static double factor_of(const struct work *work, uint32_t gone, uint32_t target,
			const struct link *gone_link)
{
	struct link target_link;
	uint32_t at_edge = gone_link->triangles[find_in(gone_link, target)], left;
	enum link_state state;
	double factor = 1.0;

	if (at_edge > STREAM_FACES_MAX || !get_link(&target_link, work, target))
		return 0.0;
	left = target_link.degree + gone_link->degree - 2 * at_edge;
	if (left == 0 || left > STREAM_RING_MAX)
		return 0.0;
	state = link_condition(work, gone, target, gone_link, &target_link, at_edge);
	if (state == LINK_BROKEN)
		return 0.0;
	/* A vertex of a border, or of an edge with three triangles, moves along it. */
	if (state == LINK_PINCHED ||
	    (gone_link->special && (gone_link->special != 2 || at_edge == 2)))
		factor = LEAVES_FACTOR;
	if (folds(work, gone, target))
		factor *= FOLDS_FACTOR;
	return factor > 1.0 && !work->options->loose ? 0.0 : factor;
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

/* The area times the squared distance to where the piece vanishes. */
static double piece_cost(const struct work *work, const uint32_t *piece, uint32_t count)
{
	double largest = 0.0, area = 0.0;

	for (uint32_t i = 0; i < count; i++) {
		double a[3], b[3], c[3], normal[3], square = 0.0;

		position_of(a, work, piece[0]);
		position_of(b, work, piece[i]);
		for (int k = 0; k < 3; k++)
			square += (a[k] - b[k]) * (a[k] - b[k]);
		largest = square > largest ? square : largest;
		for (uint32_t at = work->first[piece[i]]; at != STREAM_NONE; at = work->next[at]) {
			position_of(a, work, work->triangles[at / 3][0]);
			position_of(b, work, work->triangles[at / 3][1]);
			position_of(c, work, work->triangles[at / 3][2]);
			area += cross_of(normal, a, b, c) / 2; /* three times, as in quadrics */
		}
	}
	return area * largest;
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
		double to[3], cost, factor;

		position_of(to, work, link.vertices[i]);
		cost = quadric_at(&work->quadrics[vertex], to);
		if (cost >= best.cost)
			continue;
		factor = factor_of(work, vertex, link.vertices[i], &link);
		if (factor > 0.0 && cost * factor < best.cost) {
			best.cost = cost * factor;
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
	double from[3], to[3];

	position_of(from, work, choice->gone);
	position_of(to, work, choice->target);
	item.cost = fmax(quadric_at(&work->quadrics[choice->gone], to) -
				 quadric_at(&work->quadrics[choice->gone], from),
			 0.0);
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

static int vanish(struct work *work, uint32_t vertex, double cost)
{
	struct stream_collapses *out = work->out;
	struct stream_collapse item = {
		.target = STREAM_NONE, .gone = vertex, .cost = cost, .round = work->round
	};
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

/* Returns the number of collapses, or an error. The costlier half of the choices waits for a later
 * round: by then there may be better ones. */
static int do_round(struct work *work)
{
	uint32_t most, half, count = 0;
	int rc = 0;

	work->choice_count = 0;
	work->round++;
	memset(work->locked, 0, work->vertex_count);
	for (uint32_t v = 0; v < work->vertex_count; v++)
		choose(work, v);
	qsort(work->choices, work->choice_count, sizeof(*work->choices), compare_choices);
	most = work->alive / SHARE + 1;
	half = (work->choice_count + 1) / 2;
	for (uint32_t i = 0; rc == 0 && i < half && count < most; i++) {
		if (work->alive <= work->options->base_vertices)
			break;
		const struct choice *choice = &work->choices[i];

		if (!star_free(work, choice->gone) ||
		    (choice->target != STREAM_NONE && !star_free(work, choice->target)))
			continue;
		lock_star(work, choice->gone);
		if (choice->target != STREAM_NONE)
			lock_star(work, choice->target);
		rc = choice->target == STREAM_NONE ? vanish(work, choice->gone, choice->cost)
						   : collapse(work, choice);
		count++;
	}
	return rc < 0 ? rc : (int)count;
}

/* Returns whether no other triangle has the edge from a to b, in either direction. */
static bool is_border(const struct work *work, uint32_t triangle, uint32_t a, uint32_t b)
{
	for (uint32_t at = work->first[a]; at != STREAM_NONE; at = work->next[at]) {
		const uint32_t *corners = work->triangles[at / 3];

		if (at / 3 != triangle && (corners[0] == b || corners[1] == b || corners[2] == b))
			return false;
	}
	return true;
}

/* Planes through the borders, upright on their triangles, so that leaving a border costs
 * something (Garland and Heckbert 1997, section 6). */
static void add_borders(struct work *work, uint32_t triangle_count)
{
	for (uint32_t corner = 0; corner < 3 * triangle_count; corner++) {
		const uint32_t *corners = work->triangles[corner / 3];
		uint32_t from = corners[corner % 3], to = corners[(corner % 3 + 1) % 3];
		double a[3], b[3], c[3], normal[3], upright[3], length, square = 0.0;

		if (!is_border(work, corner / 3, from, to))
			continue;
		position_of(a, work, from);
		position_of(b, work, to);
		position_of(c, work, corners[(corner % 3 + 2) % 3]);
		if (cross_of(normal, a, b, c) == 0.0)
			continue;
		for (int i = 0; i < 3; i++) {
			normal[i] += a[i];
			square += (b[i] - a[i]) * (b[i] - a[i]);
		}
		length = cross_of(upright, a, b, normal);
		for (int i = 0; i < 3; i++)
			upright[i] /= length;
		quadric_add_plane(&work->quadrics[from], upright, a, square / 2);
		quadric_add_plane(&work->quadrics[to], upright, a, square / 2);
	}
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
			work->out->area += length / 2;
		}
	}
}

int stream_collapse(struct stream_collapses *out, const struct patch_vertex *vertices,
		    uint32_t vertex_count, uint32_t (*triangles)[3], uint32_t triangle_count,
		    const struct stream_options *options)
{
	struct work work = { .options = options,
			     .out = out,
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
		add_borders(&work, triangle_count);
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
