/* Rounds of division: every triangle that is new says which of its edges are to be divided; edges
 * are divided at their middle; triangles with divided edges become two, three or four. Edges are
 * known by the places of their ends (pipeline/import/mesh_places.h). */
#include "pipeline/deform/bend_split.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/map.h"
#include "base/parallel.h"
#include "base/spill.h"
#include "pipeline/import/mesh_places.h"

enum {
	RANGE_TRIANGLES = 1 << 14,
	ROUNDS_MAX = 40, /* halving an edge so often leaves nothing of it */
	VERTICES_MAX = INT32_MAX,
	/* in `wants`: bits 0 to 2 are edges to be divided, edge k from corner k to the next */
	SETTLED = 8,
};

struct splitter {
	struct mesh *mesh;       /* borrowed */
	const struct warp *warp; /* borrowed */
	double tolerance;
	uint32_t
		*place; /* of mesh_places; NULL: every vertex is the only one at its place; owned */
	uint8_t *wants; /* of each triangle; owned */
	uint32_t vertex_room, triangle_room;
	struct map edges;   /* from places of the ends to the place in the middle */
	struct map middles; /* from the vertices at the ends to the vertex in the middle */
};

static uint32_t place_of(const struct splitter *s, uint32_t vertex)
{
	return s->place ? s->place[vertex] : vertex;
}

static map_key edge_key(uint32_t a, uint32_t b)
{
	return a < b ? (map_key)a << 32 | b : (map_key)b << 32 | a;
}

/* ---- what is to be divided */

static void mix(double out[3], const double a[3], const double b[3], double share)
{
	for (int k = 0; k < 3; k++)
		out[k] = a[k] + share * (b[k] - a[k]);
}

static double distance(const double a[3], const double b[3])
{
	const double d[3] = { a[0] - b[0], a[1] - b[1], a[2] - b[2] };

	return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

/* A triangle, as it is and as its corners go. */
struct corners {
	double from[3][3], to[3][3];
};

static bool edge_bends(const struct splitter *s, const double from_a[3], const double from_b[3],
		       const double to_a[3], const double to_b[3])
{
	for (int quarter = 1; quarter < 4; quarter++) {
		double from[3], to[3], flat[3];

		mix(from, from_a, from_b, quarter * 0.25);
		s->warp->place(s->warp->data, from, to, NULL);
		mix(flat, to_a, to_b, quarter * 0.25);
		if (distance(to, flat) > s->tolerance)
			return true;
	}
	return false;
}

static bool middle_bends(const struct splitter *s, const struct corners *c)
{
	double from[3], to[3], flat[3];

	for (int k = 0; k < 3; k++) {
		from[k] = (c->from[0][k] + c->from[1][k] + c->from[2][k]) / 3;
		flat[k] = (c->to[0][k] + c->to[1][k] + c->to[2][k]) / 3;
	}
	s->warp->place(s->warp->data, from, to, NULL);
	return distance(to, flat) > s->tolerance;
}

static uint8_t judge(const struct splitter *s, const uint32_t triangle[3])
{
	double low[3], high[3], length[3], longest = 0, bound, grain;
	struct corners c;
	uint8_t wants = 0;
	int longest_edge = 0;

	for (int v = 0; v < 3; v++)
		for (int k = 0; k < 3; k++)
			c.from[v][k] = (double)s->mesh->positions[triangle[v]][k];
	for (int k = 0; k < 3; k++) {
		low[k] = fmin(c.from[0][k], fmin(c.from[1][k], c.from[2][k]));
		high[k] = fmax(c.from[0][k], fmax(c.from[1][k], c.from[2][k]));
		length[k] = distance(c.from[k], c.from[(k + 1) % 3]);
		if (length[k] > longest) {
			longest = length[k];
			longest_edge = k;
		}
	}
	bound = s->warp->bound(s->warp->data, low, high, &grain);
	if (!(bound * longest * longest / 8 > s->tolerance))
		return 0;
	for (int v = 0; v < 3; v++)
		s->warp->place(s->warp->data, c.from[v], c.to[v], NULL);
	for (int k = 0; k < 3; k++) {
		const int next = (k + 1) % 3;

		if (length[k] > grain ||
		    edge_bends(s, c.from[k], c.from[next], c.to[k], c.to[next]))
			wants |= (uint8_t)(1 << k);
	}
	if (!wants && middle_bends(s, &c))
		wants = (uint8_t)(1 << longest_edge);
	return wants;
}

static int judge_range(void *user, uint32_t first, uint32_t after, uint32_t worker)
{
	const struct splitter *s = user;
	(void)worker;

	for (uint32_t t = first; t < after; t++) {
		if (s->wants[t] != SETTLED)
			s->wants[t] = judge(s, s->mesh->triangles[t]) | SETTLED;
		spill_pass(t);
	}
	return 0;
}

/* Collects the edges to be divided; their middles are not known yet. */
static int collect_edges(struct splitter *s)
{
	for (uint32_t t = 0; t < s->mesh->triangle_count; t++) {
		for (int k = 0; k < 3; k++) {
			const uint32_t *corners = s->mesh->triangles[t];

			if (!(s->wants[t] & 1 << k))
				continue;
			if (map_add(&s->edges,
				    edge_key(place_of(s, corners[k]),
					     place_of(s, corners[(k + 1) % 3])),
				    UINT32_MAX) < 0)
				return -ENOMEM;
		}
		s->wants[t] &= SETTLED;
		spill_pass(t);
	}
	return 0;
}

/* ---- growing the mesh */

static uint32_t grown(uint32_t room, uint32_t needed)
{
	const uint64_t more = (uint64_t)room + room / 2 + 1024;

	return more > needed ? (uint32_t)(more < UINT32_MAX ? more : UINT32_MAX) : needed;
}

static int reserve_vertex(struct splitter *s)
{
	struct mesh *mesh = s->mesh;
	const uint32_t old = s->vertex_room;
	uint32_t room;
	int rc;

	if (mesh->vertex_count >= VERTICES_MAX)
		return -EFBIG;
	if (mesh->vertex_count < old)
		return 0;
	room = grown(old, old + 1);
	rc = SPILL_RESIZE(mesh->positions, old, room);
	if (rc == 0 && mesh->colours)
		rc = SPILL_RESIZE(mesh->colours, old, room);
	if (rc == 0 && mesh->uvs)
		rc = SPILL_RESIZE(mesh->uvs, old, room);
	if (rc == 0 && s->place)
		rc = SPILL_RESIZE(s->place, old, room);
	if (rc == 0)
		s->vertex_room = room;
	return rc;
}

static int reserve_triangles(struct splitter *s, uint32_t more, uint32_t triangles_max)
{
	struct mesh *mesh = s->mesh;
	const uint32_t old = s->triangle_room;
	uint32_t room;
	int rc;

	if ((uint64_t)mesh->triangle_count + more > triangles_max)
		return -EFBIG;
	if (mesh->triangle_count + more <= old)
		return 0;
	room = grown(old, old + more);
	rc = SPILL_RESIZE(mesh->triangles, old, room);
	if (rc == 0 && mesh->materials)
		rc = SPILL_RESIZE(mesh->materials, old, room);
	if (rc == 0 && mesh->faces)
		rc = SPILL_RESIZE(mesh->faces, old, room);
	if (rc == 0)
		rc = SPILL_RESIZE(s->wants, old, room);
	if (rc == 0)
		s->triangle_room = room;
	return rc;
}

/* Both sides of a seam must get the same bits, whichever end comes first: the sum of two floats
 * does not depend on their order. */
static int add_middle(struct splitter *s, uint32_t a, uint32_t b, uint32_t *out)
{
	struct mesh *mesh = s->mesh;
	int rc = reserve_vertex(s);

	if (rc < 0)
		return rc;
	*out = mesh->vertex_count++;
	for (int k = 0; k < 3; k++)
		mesh->positions[*out][k] =
			(float)(((double)mesh->positions[a][k] + (double)mesh->positions[b][k]) /
				2);
	for (int k = 0; k < 4 && mesh->colours; k++)
		mesh->colours[*out][k] =
			(uint8_t)((mesh->colours[a][k] + mesh->colours[b][k] + 1) / 2);
	for (int k = 0; k < 2 && mesh->uvs; k++)
		mesh->uvs[*out][k] = (mesh->uvs[a][k] + mesh->uvs[b][k]) / 2;
	if (memcmp(mesh->positions[*out], mesh->positions[a], sizeof(*mesh->positions)) == 0 ||
	    memcmp(mesh->positions[*out], mesh->positions[b], sizeof(*mesh->positions)) == 0)
		return -EDOM;
	return 0;
}

/* Finds the vertex in the middle of a triangle's edge, or makes it. *out is UINT32_MAX if the edge
 * is not divided. */
static int find_middle(struct splitter *s, uint32_t a, uint32_t b, uint32_t *out)
{
	const map_key edge = edge_key(place_of(s, a), place_of(s, b));
	uint64_t place = map_get(&s->edges, edge), vertex;
	int rc;

	*out = UINT32_MAX;
	if (place == MAP_NONE)
		return 0;
	vertex = map_get(&s->middles, edge_key(a, b));
	if (vertex != MAP_NONE) {
		*out = (uint32_t)vertex;
		return 0;
	}
	rc = add_middle(s, a, b, out);
	if (rc < 0)
		return rc;
	if (place == UINT32_MAX) {
		place = *out;
		rc = map_set(&s->edges, edge, place);
	}
	if (s->place)
		s->place[*out] = (uint32_t)place;
	return rc == 0 ? map_set(&s->middles, edge_key(a, b), *out) : rc;
}

/* ---- dividing triangles */

static void add_triangle(struct splitter *s, uint32_t like, uint32_t a, uint32_t b, uint32_t c)
{
	struct mesh *mesh = s->mesh;
	const uint32_t t = mesh->triangle_count++;

	mesh->triangles[t][0] = a;
	mesh->triangles[t][1] = b;
	mesh->triangles[t][2] = c;
	if (mesh->materials)
		mesh->materials[t] = mesh->materials[like];
	if (mesh->faces)
		mesh->faces[t] = mesh->faces[like];
	s->wants[t] = 0;
}

static void set_triangle(struct splitter *s, uint32_t t, uint32_t a, uint32_t b, uint32_t c)
{
	s->mesh->triangles[t][0] = a;
	s->mesh->triangles[t][1] = b;
	s->mesh->triangles[t][2] = c;
	s->wants[t] = 0;
}

static double edge_length(const struct mesh *mesh, uint32_t a, uint32_t b)
{
	double sum = 0;

	for (int k = 0; k < 3; k++) {
		const double d = (double)mesh->positions[a][k] - (double)mesh->positions[b][k];

		sum += d * d;
	}
	return sum;
}

/* Two divided edges meet in corner 1, so a triangle is cut off there, and the rest is halved along
 * its shorter diagonal. v: corners; m: middles of the edges from corner 0 and from corner 1. */
static void split_two(struct splitter *s, uint32_t t, const uint32_t v[3], uint32_t m0, uint32_t m1)
{
	set_triangle(s, t, m0, v[1], m1);
	if (edge_length(s->mesh, v[0], m1) <= edge_length(s->mesh, m0, v[2])) {
		add_triangle(s, t, v[0], m0, m1);
		add_triangle(s, t, v[0], m1, v[2]);
	} else {
		add_triangle(s, t, m0, m1, v[2]);
		add_triangle(s, t, m0, v[2], v[0]);
	}
}

/* Divides a triangle at the middles of its edges; UINT32_MAX: that edge is whole. */
static void split(struct splitter *s, uint32_t t, const uint32_t middle[3])
{
	uint32_t v[3], count = 0;
	int first = 0;

	for (int k = 0; k < 3; k++)
		count += middle[k] != UINT32_MAX;
	/* Turn the triangle so that edge 0 is divided, and edge 2 is whole if another one is. */
	while (count > 0 && count < 3 &&
	       !(middle[first] != UINT32_MAX && middle[(first + 2) % 3] == UINT32_MAX))
		first++;
	for (int k = 0; k < 3; k++)
		v[k] = s->mesh->triangles[t][(first + k) % 3];
	if (count == 1) {
		set_triangle(s, t, v[0], middle[first], v[2]);
		add_triangle(s, t, middle[first], v[1], v[2]);
	} else if (count == 2) {
		split_two(s, t, v, middle[first], middle[(first + 1) % 3]);
	} else if (count == 3) {
		set_triangle(s, t, middle[0], middle[1], middle[2]);
		add_triangle(s, t, v[0], middle[0], middle[2]);
		add_triangle(s, t, middle[0], v[1], middle[1]);
		add_triangle(s, t, middle[2], middle[1], v[2]);
	}
}

static int split_all(struct splitter *s, uint32_t triangles_max)
{
	const uint32_t count = s->mesh->triangle_count;
	int rc = 0;

	for (uint32_t t = 0; t < count && rc == 0; t++) {
		uint32_t v[3], middle[3], more = 0;

		memcpy(v, s->mesh->triangles[t], sizeof(v));
		for (int k = 0; k < 3 && rc == 0; k++) {
			rc = find_middle(s, v[k], v[(k + 1) % 3], &middle[k]);
			more += rc == 0 && middle[k] != UINT32_MAX;
		}
		if (rc == 0)
			rc = reserve_triangles(s, more, triangles_max);
		if (rc == 0)
			split(s, t, middle);
		spill_pass(t);
	}
	return rc;
}

int bend_split(struct mesh *mesh, const struct warp *warp, double tolerance, uint32_t triangles_max,
	       uint32_t jobs)
{
	struct splitter s = { .mesh = mesh, .warp = warp, .tolerance = tolerance };
	int rc = mesh_places(&s.place, mesh, jobs);

	s.vertex_room = mesh->vertex_count;
	s.triangle_room = mesh->triangle_count;
	if (rc == 0) {
		s.wants = spill_alloc(mesh->triangle_count);
		rc = s.wants ? 0 : -errno;
	}
	for (int round = 0; rc == 0 && round < ROUNDS_MAX; round++) {
		map_clear(&s.edges);
		map_clear(&s.middles);
		rc = parallel_ranges(jobs, mesh->triangle_count, RANGE_TRIANGLES, judge_range, &s);
		if (rc == 0)
			rc = collect_edges(&s);
		if (rc < 0 || s.edges.count == 0)
			break;
		rc = split_all(&s, triangles_max);
	}
	if (mesh->scan_count > 0)
		mesh->scans[0].triangle_count = mesh->triangle_count;
	map_finish(&s.edges);
	map_finish(&s.middles);
	spill_free(s.place);
	spill_free(s.wants);
	return rc;
}
