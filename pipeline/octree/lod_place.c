/* Adds up quadrics from the leaves to the root, level by level. */
#include "pipeline/octree/lod_place.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"

/* Keeps a vertex of a flat place near its edge: a plane through the start in each direction, with
 * that share of the area's weight. */
static const double hold = 0.02;
/* Share of the way to the least value: the nodes around an edge are two widths wide, so where the
 * surface is round, the whole way goes beyond it (a ball of 200 triangles gets 6 % too large). */
static const double step_share = 0.75;
/* A vertex moves at most by that share of the node's width along each axis. */
static const double move_most = 0.5;

/* Sum over triangles of area times squared distance from their plane:
 * x . matrix x - 2 vector . x + rest. Leaf cubes. */
struct quadric {
	double matrix[6]; /* xx xy xz yy yz zz */
	double vector[3], rest, area;
};

struct placing {
	struct lod_tree *tree;
	struct lod_vertex *vertices; /* first those of the leaves, then level by level */
	uint32_t count, room;
	uint32_t *copies;       /* of each vertex of the leaves: its last copy; owned */
	struct quadric *inner;  /* of each node above the leaves; owned */
	struct quadric *around; /* of each vertex of the level: of the nodes around it; owned */
	uint32_t around_room;
};

/* ---- quadrics */

static void place_of(double out[3], const struct lod_vertex *vertex)
{
	for (int k = 0; k < 3; k++)
		out[k] = (double)vertex->place[k] / LOD_CUBE_STEPS;
}

static void add_quadric(struct quadric *to, const struct quadric *from)
{
	for (int k = 0; k < 6; k++)
		to->matrix[k] += from->matrix[k];
	for (int k = 0; k < 3; k++)
		to->vector[k] += from->vector[k];
	to->rest += from->rest;
	to->area += from->area;
}

static void add_triangle(struct quadric *to, const double p[3][3])
{
	double u[3], v[3], n[3], twice, area, from_zero;

	for (int k = 0; k < 3; k++) {
		u[k] = p[1][k] - p[0][k];
		v[k] = p[2][k] - p[0][k];
	}
	for (int k = 0; k < 3; k++)
		n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
	twice = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
	if (!(twice > 0))
		return;
	area = twice / 2;
	for (int k = 0; k < 3; k++)
		n[k] /= twice;
	from_zero = n[0] * p[0][0] + n[1] * p[0][1] + n[2] * p[0][2];
	for (int k = 0, i = 0; k < 3; k++) {
		for (int l = k; l < 3; l++)
			to->matrix[i++] += area * n[k] * n[l];
		to->vector[k] += area * n[k] * from_zero;
	}
	to->rest += area * from_zero * from_zero;
	to->area += area;
}

static void add_leaf(struct quadric *to, const struct placing *placing, const struct lod_node *leaf)
{
	const struct cube_case *drawn = cube_case_of(leaf->inside);

	for (int t = 0; t < drawn->triangle_count; t++) {
		double p[3][3];

		for (int i = 0; i < 3; i++)
			place_of(p[i], &placing->vertices[leaf->vertices[drawn->triangles[t][i]]]);
		add_triangle(to, (const double(*)[3])p);
	}
}

static void add_children(struct quadric *to, const struct placing *placing,
			 const struct lod_node *node)
{
	const struct lod_tree *tree = placing->tree;
	const uint32_t children = (uint32_t)__builtin_popcount(node->child_mask);

	for (uint32_t i = node->first_child; i < node->first_child + children; i++)
		if (tree->nodes[i].child_mask)
			add_quadric(to, &placing->inner[i]);
		else
			add_leaf(to, placing, &tree->nodes[i]);
}

static double quadric_at(const struct quadric *quadric, const double x[3])
{
	const double *m = quadric->matrix, *v = quadric->vector;
	const double sum = x[0] * (m[0] * x[0] + 2 * (m[1] * x[1] + m[2] * x[2] - v[0])) +
			   x[1] * (m[3] * x[1] + 2 * (m[4] * x[2] - v[1])) +
			   x[2] * (m[5] * x[2] - 2 * v[2]) + quadric->rest;

	return fmax(sum, 0); /* rounding */
}

/* Sets the step from a place to the least value of the quadric, held to the place. */
static void least_step(double step[3], const struct quadric *quadric, const double at[3])
{
	const double *m = quadric->matrix, held = hold * quadric->area;
	const double xx = m[0] + held, xy = m[1], xz = m[2], yy = m[3] + held, yz = m[4],
		     zz = m[5] + held;
	const double r[3] = {
		quadric->vector[0] - m[0] * at[0] - xy * at[1] - xz * at[2],
		quadric->vector[1] - xy * at[0] - m[3] * at[1] - yz * at[2],
		quadric->vector[2] - xz * at[0] - yz * at[1] - m[5] * at[2],
	};
	/* the inverse by cofactors */
	const double a = yy * zz - yz * yz, b = xz * yz - xy * zz, c = xy * yz - xz * yy;
	const double d = xx * zz - xz * xz, e = xy * xz - xx * yz, f = xx * yy - xy * xy;
	const double determinant = xx * a + xy * b + xz * c;

	memset(step, 0, 3 * sizeof(*step));
	if (!(determinant > 0))
		return;
	step[0] = (a * r[0] + b * r[1] + c * r[2]) / determinant;
	step[1] = (b * r[0] + d * r[1] + e * r[2]) / determinant;
	step[2] = (c * r[0] + e * r[1] + f * r[2]) / determinant;
}

/* ---- a level */

/* Replaces a vertex of the leaves by the level's copy of it, which lies on the same edge of all
 * nodes around. */
static int copy_vertex(struct placing *placing, uint32_t first, uint32_t *vertex)
{
	uint32_t *copy = &placing->copies[*vertex];
	int rc = 0;

	if (*copy < first) {
		rc = ARRAY_RESERVE(placing->vertices, placing->room, placing->count + 1ull,
				   LOD_NONE - 1);
		if (rc == 0)
			rc = ARRAY_RESERVE(placing->around, placing->around_room,
					   placing->count - first + 1ull, LOD_NONE - 1);
		if (rc < 0)
			return rc;
		placing->around[placing->count - first] = (struct quadric){ 0 };
		placing->vertices[placing->count] = placing->vertices[*vertex];
		*copy = placing->count++;
	}
	*vertex = *copy;
	return rc;
}

static int copy_vertices(struct placing *placing, uint32_t first, uint32_t index)
{
	struct lod_node *node = &placing->tree->nodes[index];
	int rc = 0;

	for (int e = 0; e < CUBE_EDGES && rc == 0; e++) {
		if (node->vertices[e] == LOD_NONE)
			continue;
		rc = copy_vertex(placing, first, &node->vertices[e]);
		if (rc == 0)
			add_quadric(&placing->around[node->vertices[e] - first],
				    &placing->inner[index]);
	}
	return rc;
}

static void move_vertex(struct lod_vertex *vertex, const struct quadric *around, double most)
{
	double at[3], step[3];

	place_of(at, vertex);
	least_step(step, around, at);
	for (int k = 0; k < 3; k++)
		vertex->place[k] += (int32_t)lrint(LOD_CUBE_STEPS *
						   fmax(-most, fmin(most, step_share * step[k])));
}

/* A node that has no surface of its own loses all of it: as if it lay a node's width away. */
static float gain_of(const struct placing *placing, uint32_t index, double width)
{
	const struct lod_node *node = &placing->tree->nodes[index];
	double sum = 0;
	int count = 0;

	for (int e = 0; e < CUBE_EDGES; e++) {
		double at[3];

		if (node->vertices[e] == LOD_NONE)
			continue;
		place_of(at, &placing->vertices[node->vertices[e]]);
		sum += quadric_at(&placing->inner[index], at);
		count++;
	}
	return (float)(count > 0 ? sum / count : width * width * placing->inner[index].area);
}

static int place_level(struct placing *placing, uint32_t level, float *gains)
{
	const struct lod_tree *tree = placing->tree;
	const uint32_t begin = tree->level_first[level], end = tree->level_first[level + 1];
	const uint32_t first = placing->count;
	const double width = 1u << (tree->level_count - 1 - level);
	int rc = 0;

	for (uint32_t i = begin; i < end && rc == 0; i++) {
		add_children(&placing->inner[i], placing, &tree->nodes[i]);
		rc = copy_vertices(placing, first, i);
	}
	if (rc < 0)
		return rc;
	for (uint32_t v = first; v < placing->count; v++)
		move_vertex(&placing->vertices[v], &placing->around[v - first], move_most * width);
	for (uint32_t i = begin; i < end; i++)
		gains[i] = gain_of(placing, i, width);
	return 0;
}

int lod_place(float **gains, struct lod_tree *tree, struct lod_vertex **vertices,
	      uint32_t *vertex_count)
{
	const size_t inner = tree->level_first[tree->level_count - 1];
	struct placing placing = {
		.tree = tree, .vertices = *vertices, .count = *vertex_count, .room = *vertex_count
	};
	int rc;

	*gains = malloc((inner + 1) * sizeof(**gains));
	placing.copies = calloc(*vertex_count + (size_t)1, sizeof(*placing.copies));
	placing.inner = calloc(inner + 1, sizeof(*placing.inner));
	rc = *gains && placing.copies && placing.inner ? 0 : -ENOMEM;
	for (uint32_t level = tree->level_count - 1; level-- > 0 && rc == 0;)
		rc = place_level(&placing, level, *gains);
	*vertices = placing.vertices;
	*vertex_count = placing.count;
	free(placing.copies);
	free(placing.inner);
	free(placing.around);
	if (rc < 0) {
		free(*gains);
		*gains = NULL;
	}
	return rc;
}
