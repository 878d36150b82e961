/* A bounding-volume tree over triangles, split at the median, and its nearest-point search. */
#include "pipeline/release/nearest.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/vec.h"

enum { LEAF_TRIANGLES = 8, DEPTH_MAX = 64 };

struct node {
	float low[3], high[3];
	uint32_t first, count; /* a run of order; an inner node's children: the next, right */
	uint32_t right;        /* 0: a leaf */
};

struct nearest {
	float (*positions)[3];
	uint32_t (*triangles)[3];
	uint32_t *order;    /* owned; the triangles in tree order */
	struct node *nodes; /* owned */
	uint32_t node_count;
};

/* ---- building */

static const float *corner(const struct nearest *n, uint32_t triangle, int k)
{
	return n->positions[n->triangles[triangle][k]];
}

static float key_of(const struct nearest *n, uint32_t triangle, int axis)
{
	return corner(n, triangle, 0)[axis] + corner(n, triangle, 1)[axis] +
	       corner(n, triangle, 2)[axis];
}

static void bound(const struct nearest *n, struct node *node)
{
	for (int i = 0; i < 3; i++) {
		node->low[i] = INFINITY;
		node->high[i] = -INFINITY;
	}
	for (uint32_t t = node->first; t < node->first + node->count; t++)
		for (int k = 0; k < 3; k++) {
			const float *at = corner(n, n->order[t], k);

			for (int i = 0; i < 3; i++) {
				node->low[i] = vec_least(node->low[i], at[i]);
				node->high[i] = vec_most(node->high[i], at[i]);
			}
		}
}

/* Wirth's selection: moves the median triangle along an axis to the middle of the run. */
static void split_at_median(struct nearest *n, const struct node *node, int axis)
{
	int64_t low = node->first, high = low + node->count - 1, middle = low + node->count / 2;

	while (low < high) {
		float pivot = key_of(n, n->order[middle], axis);
		int64_t i = low, j = high;

		while (i <= j) {
			while (key_of(n, n->order[i], axis) < pivot)
				i++;
			while (key_of(n, n->order[j], axis) > pivot)
				j--;
			if (i <= j) {
				uint32_t kept = n->order[i];

				n->order[i++] = n->order[j];
				n->order[j--] = kept;
			}
		}
		if (j < middle)
			low = i;
		if (middle < i)
			high = j;
	}
}

static uint32_t build(struct nearest *n, uint32_t first, uint32_t count)
{
	uint32_t self = n->node_count++, right;
	struct node *node = &n->nodes[self];
	int axis = 0;

	*node = (struct node){ .first = first, .count = count };
	bound(n, node);
	if (count <= LEAF_TRIANGLES)
		return self;
	for (int i = 1; i < 3; i++)
		if (node->high[i] - node->low[i] > node->high[axis] - node->low[axis])
			axis = i;
	split_at_median(n, node, axis);
	build(n, first, count / 2);
	right = build(n, first + count / 2, count - count / 2);
	n->nodes[self].right = right;
	return self;
}

int nearest_create(struct nearest **out, float (*positions)[3], uint32_t (*triangles)[3],
		   uint32_t triangle_count)
{
	struct nearest *n = calloc(1, sizeof(*n));

	*out = NULL;
	if (!n)
		return -ENOMEM;
	n->positions = positions;
	n->triangles = triangles;
	/* A split leaves at least four triangles in a leaf, unless the tree is a single leaf. */
	n->nodes = calloc((size_t)triangle_count / 2 + 1, sizeof(*n->nodes));
	n->order = malloc(((size_t)triangle_count + 1) * sizeof(*n->order));
	if (!n->nodes || !n->order) {
		nearest_destroy(n);
		return -ENOMEM;
	}
	for (uint32_t t = 0; t < triangle_count; t++)
		n->order[t] = t;
	if (triangle_count > 0)
		build(n, 0, triangle_count);
	*out = n;
	return 0;
}

void nearest_destroy(struct nearest *nearest)
{
	if (!nearest)
		return;
	free(nearest->order);
	free(nearest->nodes);
	free(nearest);
}

/* ---- queries */

static void point_between(float out[3], const float a[3], const float b[3], float share)
{
	for (int i = 0; i < 3; i++)
		out[i] = a[i] + share * (b[i] - a[i]);
}

/* Nearest point of a triangle, by the Voronoi region of corner, edge or face that contains p
 * (Ericson, "Real-Time Collision Detection", 2005, 5.1.5). */
static void nearest_of_triangle(float out[3], const float p[3], const float a[3], const float b[3],
				const float c[3])
{
	float ab[3], ac[3], ap[3], bp[3], cp[3];

	vec_sub(ab, b, a);
	vec_sub(ac, c, a);
	vec_sub(ap, p, a);
	vec_sub(bp, p, b);
	vec_sub(cp, p, c);

	float d1 = vec_dot(ab, ap), d2 = vec_dot(ac, ap), d3 = vec_dot(ab, bp);
	float d4 = vec_dot(ac, bp), d5 = vec_dot(ab, cp), d6 = vec_dot(ac, cp);
	float va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;

	if (d1 <= 0 && d2 <= 0)
		memcpy(out, a, 3 * sizeof(*out));
	else if (d3 >= 0 && d4 <= d3)
		memcpy(out, b, 3 * sizeof(*out));
	else if (vc <= 0 && d1 >= 0 && d3 <= 0)
		point_between(out, a, b, d1 > d3 ? d1 / (d1 - d3) : 0);
	else if (d6 >= 0 && d5 <= d6)
		memcpy(out, c, 3 * sizeof(*out));
	else if (vb <= 0 && d2 >= 0 && d6 <= 0)
		point_between(out, a, c, d2 > d6 ? d2 / (d2 - d6) : 0);
	else if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
		point_between(out, b, c,
			      d4 - d3 + d5 - d6 > 0 ? (d4 - d3) / (d4 - d3 + d5 - d6) : 0);
	else
		for (int i = 0; i < 3; i++)
			out[i] = a[i] + (vb * ab[i] + vc * ac[i]) / (va + vb + vc);
}

bool nearest_faces(const struct nearest *n, uint32_t triangle, const float facing[3])
{
	float ab[3], ac[3], normal[3];

	vec_sub(ab, corner(n, triangle, 1), corner(n, triangle, 0));
	vec_sub(ac, corner(n, triangle, 2), corner(n, triangle, 0));
	vec_cross(normal, ab, ac);
	return vec_dot(normal, facing) > 0;
}

static float box_distance2(const struct node *node, const float p[3])
{
	float sum = 0;

	for (int i = 0; i < 3; i++) {
		float off = vec_most(vec_most(node->low[i] - p[i], p[i] - node->high[i]), 0);

		sum += off * off;
	}
	return sum;
}

struct search {
	const struct nearest *nearest;
	const float *point, *facing;
	float best2;
	struct nearest_place *out;
	bool found;
};

static void look(struct search *s, const struct node *node)
{
	const struct nearest *n = s->nearest;

	for (uint32_t i = node->first; i < node->first + node->count; i++) {
		uint32_t t = n->order[i];
		float at[3], off[3], distance2;

		nearest_of_triangle(at, s->point, corner(n, t, 0), corner(n, t, 1),
				    corner(n, t, 2));
		vec_sub(off, at, s->point);
		distance2 = vec_dot(off, off);
		/* Of equally near triangles, take the first in the mesh, independent of the
		 * tree. */
		if (distance2 > s->best2 ||
		    (s->found && distance2 == s->best2 && t > s->out->triangle) ||
		    (s->facing && !nearest_faces(n, t, s->facing)))
			continue;
		s->found = true;
		s->best2 = distance2;
		s->out->triangle = t;
		memcpy(s->out->at_m, at, sizeof(at));
	}
}

bool nearest_find(const struct nearest *nearest, const float point_m[3], const float facing[3],
		  float most_m, struct nearest_place *out)
{
	struct search s = { nearest, point_m, facing, most_m * most_m, out, false };
	uint32_t stack[DEPTH_MAX], depth = 0;

	if (nearest->node_count > 0)
		stack[depth++] = 0;
	while (depth > 0) {
		uint32_t at = stack[--depth];
		const struct node *node = &nearest->nodes[at];
		const struct node *left = node + 1, *right = &nearest->nodes[node->right];

		if (box_distance2(node, point_m) > s.best2)
			continue;
		if (!node->right) {
			look(&s, node);
			continue;
		}
		/* The nearer child is searched first. */
		bool swap = box_distance2(right, point_m) < box_distance2(left, point_m);

		stack[depth++] = swap ? at + 1 : node->right;
		stack[depth++] = swap ? node->right : at + 1;
	}
	out->distance_m = sqrtf(s.best2);
	return s.found;
}
