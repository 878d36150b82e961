/* Builds the tree with its moments, and walks it. */
#include "pipeline/octree/triangle_tree.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "base/spill.h"
#include "geometry/vec.h"

/* docs/octree.md has what larger and smaller numbers cost and give. */
static const float default_far_radii = 2;

/* Distances that differ by a smaller share are equal. */
static const float as_near = 1e-5f;

/* ---- building */

static void extend(const void *data, uint32_t number, float low[3], float high[3])
{
	const struct mesh *mesh = data;

	for (int i = 0; i < 3; i++) {
		const float *corner = mesh->positions[mesh->triangles[number][i]];

		for (int k = 0; k < 3; k++) {
			low[k] = vec_least(low[k], corner[k]);
			high[k] = vec_most(high[k], corner[k]);
		}
	}
}

static void copy_corners(struct triangle_tree *tree, const struct mesh *mesh)
{
	for (uint32_t i = 0; i < tree->triangle_count; i++) {
		for (int k = 0; k < 3; k++)
			vec_copy(tree->corners[i][k],
				 mesh->positions[mesh->triangles[tree->order[i]][k]]);
		spill_pass(i);
	}
}

/* Returns twice the area, and twice the area times the unit normal. */
static float measure(const float (*corners)[3], float normal[3])
{
	float a[3], b[3];

	vec_sub(a, corners[1], corners[0]);
	vec_sub(b, corners[2], corners[0]);
	vec_cross(normal, a, b);
	return sqrtf(vec_dot(normal, normal));
}

/* Sums the triangles of a node. Doubles: a node may have millions. */
static void sum_leaf(const struct triangle_tree *tree, const struct bvh_node *node,
		     double centre[3], double normal[3], double *area)
{
	for (uint32_t i = node->first; i < node->first + node->count; i++) {
		const float(*corners)[3] = tree->corners[i];
		float cross[3];
		const double twice = (double)measure(corners, cross);

		for (int k = 0; k < 3; k++) {
			centre[k] += twice / 6 *
				     ((double)corners[0][k] + (double)corners[1][k] +
				      (double)corners[2][k]);
			normal[k] += (double)cross[k] / 2;
		}
		*area += twice / 2;
	}
}

/* From the leaves up: children come after their parent. `areas` has room for all nodes. */
static void make_moments(struct triangle_tree *tree, float *areas)
{
	for (uint32_t n = tree->node_count; n-- > 0;) {
		const struct bvh_node *node = &tree->nodes[n];
		struct triangle_moment *moment = &tree->moments[n];
		double centre[3] = { 0 }, normal[3] = { 0 }, area = 0, squared = 0;

		if (!node->right)
			sum_leaf(tree, node, centre, normal, &area);
		for (int side = 0; side < 2 && node->right; side++) {
			const uint32_t child = side ? node->right : n + 1;

			for (int k = 0; k < 3; k++) {
				centre[k] += (double)areas[child] *
					     (double)tree->moments[child].centre[k];
				normal[k] += (double)tree->moments[child].normal[k];
			}
			area += (double)areas[child];
		}
		for (int k = 0; k < 3; k++) {
			const double low = (double)node->low[k], high = (double)node->high[k];
			const double middle = area > 0 ? centre[k] / area : (low + high) / 2;
			const double off = fmax(middle - low, high - middle);

			moment->centre[k] = (float)middle;
			moment->normal[k] = (float)normal[k];
			squared += off * off;
		}
		moment->radius = (float)sqrt(squared);
		areas[n] = (float)area;
		spill_pass(n);
	}
}

static int remake_moments(struct triangle_tree *tree)
{
	float *areas = spill_alloc(tree->node_count * sizeof(*areas));

	if (!areas)
		return -errno;
	make_moments(tree, areas);
	spill_free(areas);
	return 0;
}

static int build(struct triangle_tree *tree, const struct mesh *mesh, float *keys)
{
	struct bvh_items items = { .count = mesh->triangle_count,
				   .order = tree->order,
				   .keys = keys,
				   .key_count = 3,
				   .extend = extend,
				   .data = mesh };

	for (uint32_t i = 0; i < mesh->triangle_count; i++) {
		const uint32_t *triangle = mesh->triangles[i];

		tree->order[i] = i;
		for (int k = 0; k < 3; k++)
			keys[(size_t)3 * i + (size_t)k] =
				(mesh->positions[triangle[0]][k] + mesh->positions[triangle[1]][k] +
				 mesh->positions[triangle[2]][k]) /
				3;
		spill_pass(i);
	}
	tree->node_count = bvh_build(tree->nodes, &items);
	copy_corners(tree, mesh);
	return remake_moments(tree);
}

int triangle_tree_init(struct triangle_tree *out, const struct mesh *mesh)
{
	const size_t count = mesh->triangle_count, nodes = bvh_nodes_max(mesh->triangle_count);
	float *keys = spill_alloc(3 * count * sizeof(*keys));
	int rc;

	*out = (struct triangle_tree){ .triangle_count = mesh->triangle_count,
				       .far_radii = default_far_radii };
	out->nodes = keys ? spill_alloc(nodes * sizeof(*out->nodes)) : NULL;
	out->moments = out->nodes ? spill_alloc(nodes * sizeof(*out->moments)) : NULL;
	out->order = out->moments ? spill_alloc(count * sizeof(*out->order)) : NULL;
	out->corners = out->order ? spill_alloc(count * sizeof(*out->corners)) : NULL;
	rc = out->corners ? build(out, mesh, keys) : -errno;
	spill_free(keys);
	if (rc < 0)
		triangle_tree_finish(out);
	return rc;
}

void triangle_tree_finish(struct triangle_tree *tree)
{
	if (!tree)
		return;
	spill_free(tree->nodes);
	spill_free(tree->moments);
	spill_free(tree->order);
	spill_free(tree->corners);
	*tree = (struct triangle_tree){ 0 };
}

int triangle_tree_turn(struct triangle_tree *tree, const uint8_t *turned)
{
	for (uint32_t i = 0; i < tree->triangle_count; i++) {
		float swapped[3];

		spill_pass(i);
		if (!turned[tree->order[i]])
			continue;
		vec_copy(swapped, tree->corners[i][1]);
		vec_copy(tree->corners[i][1], tree->corners[i][2]);
		vec_copy(tree->corners[i][2], swapped);
	}
	return remake_moments(tree);
}

/* ---- the winding number */

/* Returns half the solid angle of a triangle (van Oosterom and Strackee 1983). */
static float half_angle(const float (*corners)[3], const float at[3])
{
	float p[3][3], length[3], cross[3], below;

	for (int i = 0; i < 3; i++) {
		vec_sub(p[i], corners[i], at);
		length[i] = sqrtf(vec_dot(p[i], p[i]));
	}
	vec_cross(cross, p[1], p[2]);
	below = length[0] * length[1] * length[2] + vec_dot(p[0], p[1]) * length[2] +
		vec_dot(p[1], p[2]) * length[0] + vec_dot(p[2], p[0]) * length[1];
	return atan2f(vec_dot(p[0], cross), below);
}

double triangle_tree_winding(const struct triangle_tree *tree, const float at[3])
{
	uint32_t stack[BVH_STACK_MAX + 1], depth = 1;
	double sum = 0; /* of solid angles */

	stack[0] = 0;
	while (depth > 0) {
		const uint32_t n = stack[--depth];
		const struct bvh_node *node = &tree->nodes[n];
		const struct triangle_moment *moment = &tree->moments[n];
		float from[3], squared, reach = tree->far_radii * moment->radius;

		vec_sub(from, moment->centre, at);
		squared = vec_dot(from, from);
		if (squared > reach * reach) {
			sum += (double)(vec_dot(moment->normal, from) / (squared * sqrtf(squared)));
		} else if (node->right) {
			stack[depth++] = node->right;
			stack[depth++] = n + 1;
		} else {
			for (uint32_t i = node->first; i < node->first + node->count; i++)
				sum += 2 * (double)half_angle(tree->corners[i], at);
		}
	}
	return sum / (4 * 3.14159265358979);
}

/* ---- the nearest triangle */

/* Returns the share of b at the place of a line from a to b that is nearest to at. */
static float nearest_share(const float a[3], const float b[3], const float at[3])
{
	float along[3], from[3], length;

	vec_sub(along, b, a);
	vec_sub(from, at, a);
	length = vec_dot(along, along);
	return length > 0 ? vec_most(0, vec_least(1, vec_dot(from, along) / length)) : 0;
}

/* Keeps the place with these shares if it is nearer. */
static void offer(struct triangle_place *place, const float (*corners)[3], const float at[3],
		  const float shares[3])
{
	float off[3], distance;

	for (int k = 0; k < 3; k++)
		off[k] = shares[0] * corners[0][k] + shares[1] * corners[1][k] +
			 shares[2] * corners[2][k] - at[k];
	distance = sqrtf(vec_dot(off, off));
	if (!(distance < place->distance))
		return;
	place->distance = distance;
	memcpy(place->shares, shares, sizeof(place->shares));
}

/* Sets shares and distance to those of the nearest place of a triangle, if it is nearer. */
static void nearest_on(struct triangle_place *place, const float (*corners)[3], const float at[3])
{
	float normal[3], from[3], squared, shares[3];
	bool is_inside;

	measure(corners, normal);
	squared = vec_dot(normal, normal);
	is_inside = squared > 0;
	for (int i = 0; i < 3 && is_inside; i++) {
		const float *next = corners[(i + 1) % 3], *last = corners[(i + 2) % 3];
		float edge[3], cross[3];

		vec_sub(edge, last, next);
		vec_sub(from, at, next);
		vec_cross(cross, edge, from);
		shares[i] = vec_dot(cross, normal) / squared;
		is_inside = shares[i] >= 0;
	}
	if (is_inside) {
		offer(place, corners, at, shares);
		return;
	}
	for (int i = 0; i < 3; i++) {
		const int next = (i + 1) % 3;
		const float share = nearest_share(corners[i], corners[next], at);

		shares[i] = 1 - share;
		shares[next] = share;
		shares[(i + 2) % 3] = 0;
		offer(place, corners, at, shares);
	}
}

bool triangle_is_near(const float (*corners)[3], const float at[3], float reach)
{
	struct triangle_place place = { .distance = reach };

	nearest_on(&place, corners, at);
	return place.distance < reach;
}

static float box_distance_squared(const struct bvh_node *node, const float at[3])
{
	float sum = 0;

	for (int k = 0; k < 3; k++) {
		const float off =
			vec_most(0, vec_most(node->low[k] - at[k], at[k] - node->high[k]));

		sum += off * off;
	}
	return sum;
}

void triangle_tree_normal(const struct triangle_tree *tree, const struct triangle_place *place,
			  float normal[3], float at[3])
{
	const float(*corners)[3] = tree->corners[place->at];

	measure(corners, normal);
	vec_normalise(normal);
	for (int k = 0; k < 3; k++)
		at[k] = place->shares[0] * corners[0][k] + place->shares[1] * corners[1][k] +
			place->shares[2] * corners[2][k];
}

/* Returns the cosine between the normal of the triangle of a place and the way to it, 0 .. 1. */
static float lean_of(const struct triangle_tree *tree, const struct triangle_place *place,
		     const float at[3])
{
	float normal[3], off[3];

	triangle_tree_normal(tree, place, normal, off);
	vec_sub(off, off, at);
	return place->distance > 0 ? fabsf(vec_dot(off, normal)) / place->distance : 1;
}

/* Keeps triangle i if it is nearer; if it is as near, as at an edge that both share, the one that
 * faces the place more, because only that one tells on which side the place is. */
static void consider(const struct triangle_tree *tree, struct triangle_place *best, uint32_t i,
		     const float at[3])
{
	struct triangle_place place = { .distance = best->distance * (1 + as_near) };

	nearest_on(&place, tree->corners[i], at);
	if (!(place.distance < best->distance * (1 + as_near)))
		return;
	place.triangle = tree->order[i];
	place.at = i;
	if (place.distance < best->distance * (1 - as_near) ||
	    lean_of(tree, &place, at) > lean_of(tree, best, at))
		*best = place;
}

bool triangle_tree_nearest(const struct triangle_tree *tree, const float at[3], float reach,
			   struct triangle_place *out)
{
	uint32_t stack[BVH_STACK_MAX + 1], depth = 1;
	/* until one is found, that of no triangle: what lies just at reach may replace it or not */
	struct triangle_place best = { .distance = reach };

	stack[0] = 0;
	while (depth > 0) {
		const uint32_t n = stack[--depth];
		const struct bvh_node *node = &tree->nodes[n];

		if (box_distance_squared(node, at) >
		    best.distance * best.distance * (1 + 3 * as_near))
			continue;
		if (node->right) {
			const bool left_first = box_distance_squared(&tree->nodes[n + 1], at) <
						box_distance_squared(&tree->nodes[node->right], at);

			stack[depth++] = left_first ? node->right : n + 1;
			stack[depth++] = left_first ? n + 1 : node->right;
			continue;
		}
		for (uint32_t i = node->first; i < node->first + node->count; i++)
			consider(tree, &best, i, at);
	}
	if (!(best.distance < reach))
		return false;
	*out = best;
	return true;
}

/* ---- rays */

static bool ray_meets_box(const struct bvh_node *node, const float from[3], const float inverse[3])
{
	float enters = 0, leaves = INFINITY;

	for (int k = 0; k < 3; k++) {
		const float a = (node->low[k] - from[k]) * inverse[k];
		const float b = (node->high[k] - from[k]) * inverse[k];

		enters = vec_most(enters, vec_least(a, b));
		leaves = vec_least(leaves, vec_most(a, b));
	}
	return enters <= leaves * 1.00001f;
}

/* Möller and Trumbore 1997. */
static bool ray_meets(const float (*corners)[3], const float from[3], const float towards[3])
{
	float a[3], b[3], p[3], q[3], off[3], determinant, u, v;

	vec_sub(a, corners[1], corners[0]);
	vec_sub(b, corners[2], corners[0]);
	vec_cross(p, towards, b);
	determinant = vec_dot(a, p);
	if (determinant == 0)
		return false;
	vec_sub(off, from, corners[0]);
	u = vec_dot(off, p) / determinant;
	vec_cross(q, off, a);
	v = vec_dot(towards, q) / determinant;
	return u >= 0 && v >= 0 && u + v <= 1 && vec_dot(b, q) / determinant > 0;
}

uint32_t triangle_tree_crossings(const struct triangle_tree *tree, const float from[3],
				 const float towards[3], uint32_t most)
{
	uint32_t stack[BVH_STACK_MAX + 1], depth = 1, count = 0;
	float inverse[3];

	for (int k = 0; k < 3; k++)
		inverse[k] = 1 / (fabsf(towards[k]) > 1e-12f ? towards[k] : 1e-12f);
	stack[0] = 0;
	while (depth > 0 && count < most) {
		const uint32_t n = stack[--depth];
		const struct bvh_node *node = &tree->nodes[n];

		if (!ray_meets_box(node, from, inverse))
			continue;
		if (node->right) {
			stack[depth++] = node->right;
			stack[depth++] = n + 1;
			continue;
		}
		for (uint32_t i = node->first; i < node->first + node->count && count < most; i++)
			count += ray_meets(tree->corners[i], from, towards);
	}
	return count;
}
