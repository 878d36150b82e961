/* The nearest-point search over a BVH of triangles. */
#include "pipeline/release/nearest.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/bvh.h"
#include "geometry/vec.h"

struct nearest {
	float (*positions)[3];
	uint32_t (*triangles)[3];
	uint32_t *order;        /* owned; the triangles in tree order */
	struct bvh_node *nodes; /* owned */
	uint32_t node_count;
};

/* ---- building */

static const float *corner(const struct nearest *n, uint32_t triangle, int k)
{
	return n->positions[n->triangles[triangle][k]];
}

static void extend_by_triangle(const void *data, uint32_t triangle, float low[3], float high[3])
{
	const struct nearest *n = data;

	for (int k = 0; k < 3; k++) {
		const float *at = corner(n, triangle, k);

		for (int i = 0; i < 3; i++) {
			low[i] = vec_least(low[i], at[i]);
			high[i] = vec_most(high[i], at[i]);
		}
	}
}

static int build(struct nearest *n, uint32_t triangle_count)
{
	struct bvh_items items = { .count = triangle_count,
				   .order = n->order,
				   .key_count = 3,
				   .extend = extend_by_triangle,
				   .data = n };

	items.keys = malloc((size_t)triangle_count * 3 * sizeof(*items.keys));
	if (!items.keys)
		return -ENOMEM;
	for (uint32_t t = 0; t < triangle_count; t++) {
		n->order[t] = t;
		for (size_t i = 0; i < 3; i++)
			items.keys[3 * (size_t)t + i] =
				corner(n, t, 0)[i] + corner(n, t, 1)[i] + corner(n, t, 2)[i];
	}
	n->node_count = bvh_build(n->nodes, &items);
	free(items.keys);
	return 0;
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
	n->nodes = malloc(bvh_nodes_max(triangle_count) * sizeof(*n->nodes));
	n->order = malloc(((size_t)triangle_count + 1) * sizeof(*n->order));
	if (!n->nodes || !n->order || (triangle_count > 0 && build(n, triangle_count) < 0)) {
		nearest_destroy(n);
		return -ENOMEM;
	}
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
		vec_mix(out, a, b, d1 > d3 ? d1 / (d1 - d3) : 0);
	else if (d6 >= 0 && d5 <= d6)
		memcpy(out, c, 3 * sizeof(*out));
	else if (vb <= 0 && d2 >= 0 && d6 <= 0)
		vec_mix(out, a, c, d2 > d6 ? d2 / (d2 - d6) : 0);
	else if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
		vec_mix(out, b, c, d4 - d3 + d5 - d6 > 0 ? (d4 - d3) / (d4 - d3 + d5 - d6) : 0);
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

static float box_distance2(const struct bvh_node *node, const float p[3])
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

static void look(struct search *s, const struct bvh_node *node)
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
	uint32_t stack[BVH_STACK_MAX], depth = 0;

	if (nearest->node_count > 0)
		stack[depth++] = 0;
	while (depth > 0) {
		uint32_t at = stack[--depth];
		const struct bvh_node *node = &nearest->nodes[at];
		const struct bvh_node *left = node + 1, *right = &nearest->nodes[node->right];

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
