/* Joins the crossings on the faces of a node to polygons. */
#include "pipeline/octree/lod_polygon.h"

#include <string.h>

enum {
	RING_MAX = 8, /* corners and middles around a face */
	CUT_MAX = 24,
	COST_REFUSED = CUT_MAX, /* more than all diagonals that cost 1 */
	UPPER_FACES = 0x2a,     /* a bit for each face of a node on side 1 of its axis */
};

struct segment {
	uint32_t from, to; /* vertices */
	uint8_t face;
};

struct joining {
	const struct lod_tree *tree;
	uint32_t count;
	struct segment segments[LOD_SEGMENTS_MAX];
};

/* ---- faces */

/* Going round a face: whether each corner or middle lies inside, and the vertex on the way to the
 * next one. */
struct ring {
	int count;
	bool inside[RING_MAX];
	uint32_t vertices[RING_MAX];
};

static void ring_add(struct ring *ring, bool inside, uint32_t vertex)
{
	if (ring->count == RING_MAX)
		return;
	ring->inside[ring->count] = inside;
	ring->vertices[ring->count++] = vertex;
}

/* Joins each run of inside places: the crossing where it is entered to that where it is left. */
static void join_ring(struct joining *joining, const struct ring *ring, int face)
{
	const int n = ring->count;

	for (int i = 0; i < n; i++) {
		int last = i;

		if (!ring->inside[i] || ring->inside[(i + n - 1) % n])
			continue;
		while (ring->inside[(last + 1) % n])
			last = (last + 1) % n;
		if (joining->count < LOD_SEGMENTS_MAX)
			joining->segments[joining->count++] =
				(struct segment){ ring->vertices[(i + n - 1) % n],
						  ring->vertices[last], (uint8_t)(1 << face) };
	}
}

/* Adds a corner and what follows it up to the next one. */
static void add_side(struct ring *ring, const struct lod_tree *tree, const struct lod_node *node,
		     int corner, int next, bool is_split)
{
	const int edge = cube_edge_between(corner, next);
	const bool inside = node->inside >> corner & 1;
	const struct lod_node *first, *second;
	bool middle = inside;

	if (!is_split) {
		ring_add(ring, inside, node->vertices[edge]);
		return;
	}
	first = lod_child(tree, node, corner);
	second = lod_child(tree, node, next);
	if (first)
		middle = first->inside >> next & 1;
	else if (second)
		middle = second->inside >> corner & 1;
	ring_add(ring, inside, first ? first->vertices[edge] : LOD_NONE);
	ring_add(ring, middle, second ? second->vertices[edge] : LOD_NONE);
}

/* opened 0: no edge is split. */
static void join_face(struct joining *joining, const struct lod_node *node, int face,
		      uint32_t opened)
{
	struct ring ring = { 0 };
	int corners[4];

	cube_face_corners(corners, face / 2, face % 2);
	for (int i = 0; i < 4; i++) {
		const int next = corners[(i + 1) % 4];

		add_side(&ring, joining->tree, node, corners[i], next,
			 node->edge_split[cube_edge_between(corners[i], next)] < opened);
	}
	join_ring(joining, &ring, face);
}

static void join_node(struct joining *joining, const struct lod_node *node, uint32_t opened)
{
	for (int face = 0; face < LOD_CUBE_FACES; face++) {
		if (node->face_split[face] >= opened) {
			join_face(joining, node, face, opened);
			continue;
		}
		for (int c = 0; c < 8; c++) {
			const struct lod_node *child = lod_child(joining->tree, node, c);

			if (child && (c >> face / 2 & 1) == face % 2)
				join_face(joining, child, face, 0);
		}
	}
}

/* ---- polygons */

/* Follows the segments from one on. Each vertex begins one segment of the node and ends another. */
static void follow(struct lod_polygons *out, const struct joining *joining, uint64_t *used,
		   uint32_t first)
{
	const uint32_t begin = out->count > 0 ? out->ends[out->count - 1] : 0;
	uint32_t length = 0, at = first;
	uint8_t before = 0;

	for (;;) {
		const struct segment *segment = &joining->segments[at];
		uint32_t next = 0;

		*used |= 1ull << at;
		out->corners[begin + length] = segment->from;
		out->faces[begin + length++] = segment->face | before;
		before = segment->face;
		while (next < joining->count &&
		       (*used >> next & 1 || joining->segments[next].from != segment->to))
			next++;
		if (next == joining->count)
			break;
		at = next;
	}
	out->faces[begin] |= before;
	/* Two segments on one line, of two faces that have the same middles, cancel each other. */
	if (length >= 3)
		out->ends[out->count++] = (uint8_t)(begin + length);
}

void lod_polygons_find(struct lod_polygons *out, const struct lod_tree *tree,
		       const struct lod_node *node, uint32_t opened)
{
	struct joining joining = { .tree = tree };
	uint64_t used = 0;

	out->count = 0;
	join_node(&joining, node, opened);
	for (uint32_t i = 0; i < joining.count; i++)
		if (!(used >> i & 1))
			follow(out, &joining, &used, i);
}

/* ---- triangles */

/* The best ways to cut the part of a polygon between two of its corners: what its diagonals cost,
 * and the third corner of the triangle at the line between the two. */
struct division {
	uint16_t cost[CUT_MAX][CUT_MAX];
	uint8_t middle[CUT_MAX][CUT_MAX];
};

/* A diagonal in a face of the node may also be one of the node behind that face, and the edge would
 * have four triangles. So only the node above a face (along its axis) may use it, if it has no
 * better one. Up to four nodes have the corners on a common edge, so no diagonal lies along one. */
static uint32_t diagonal_cost(uint8_t faces_a, uint8_t faces_b)
{
	const uint8_t common = faces_a & faces_b;

	if ((common & UPPER_FACES) || (common & (common - 1)))
		return COST_REFUSED;
	return common != 0;
}

/* Divides a polygon of n <= CUT_MAX corners (dynamic programming over its parts). Returns false if
 * it needs a diagonal that is refused. */
static bool divide(struct division *division, const uint8_t *faces, uint32_t n)
{
	for (uint32_t k = 0; k + 1 < n; k++)
		division->cost[k][k + 1] = 0;
	for (uint32_t length = 2; length < n; length++)
		for (uint32_t a = 0; a + length < n; a++) {
			const uint32_t b = a + length;
			uint32_t least = UINT16_MAX;

			for (uint32_t m = a + 1; m < b; m++) {
				const uint32_t cost = division->cost[a][m] + division->cost[m][b];

				if (cost < least) {
					least = cost;
					division->middle[a][b] = (uint8_t)m;
				}
			}
			if (length < n - 1)
				least += diagonal_cost(faces[a], faces[b]);
			division->cost[a][b] = (uint16_t)least;
		}
	return division->cost[0][n - 1] < COST_REFUSED;
}

uint32_t lod_polygons_triangles(const struct lod_polygons *polygons)
{
	uint32_t count = 0, begin = 0;

	for (uint32_t i = 0; i < polygons->count; begin = polygons->ends[i++]) {
		const uint32_t n = polygons->ends[i] - begin;
		struct division division;
		const bool is_cut =
			n == 3 || (n <= CUT_MAX && divide(&division, polygons->faces + begin, n));

		count += is_cut ? n - 2 : n;
	}
	return count;
}

static uint32_t cut_part(uint8_t (*triangles)[3], uint32_t count, const struct division *division,
			 uint32_t begin, uint32_t i, uint32_t k)
{
	uint32_t m;

	if (k - i < 2)
		return count;
	m = division->middle[i][k];
	triangles[count][0] = (uint8_t)(begin + i);
	triangles[count][1] = (uint8_t)(begin + m);
	triangles[count++][2] = (uint8_t)(begin + k);
	count = cut_part(triangles, count, division, begin, i, m);
	return cut_part(triangles, count, division, begin, m, k);
}

uint32_t lod_polygon_cut(uint8_t (*triangles)[3], const struct lod_polygons *polygons, uint32_t i)
{
	const uint32_t begin = i > 0 ? polygons->ends[i - 1] : 0, n = polygons->ends[i] - begin;
	struct division division;

	if (n > CUT_MAX || !divide(&division, polygons->faces + begin, n))
		return 0;
	return cut_part(triangles, 0, &division, begin, 0, n - 1);
}
