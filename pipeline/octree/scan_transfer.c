/* Looks for the nearest triangle of the scan at each vertex, and in the middle of each triangle. */
#include "pipeline/octree/scan_transfer.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "base/parallel.h"
#include "base/spill.h"
#include "geometry/vec.h"

enum { RANGE_ITEMS = 1 << 12 };

struct transferring {
	struct mesh *out;
	const struct mesh *scan;
	const struct triangle_tree *tree;
	float cell_m;
	uint32_t *sources; /* of each triangle of out, one of the scan */
};

/* ---- colours */

/* Adds the colour at a place on a triangle. */
static void add_texel(float sum[4], const struct mesh *scan, uint32_t triangle,
		      const float shares[3])
{
	const uint32_t *corners = scan->triangles[triangle];
	float uv[2] = { 0, 0 };
	uint8_t rgb[3];

	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 2; k++)
			uv[k] += shares[i] * scan->uvs[corners[i]][k];
	mesh_texel(&scan->textures[scan->materials[triangle]], uv, rgb);
	for (int k = 0; k < 3; k++)
		sum[k] += rgb[k];
	sum[3]++;
}

/* The plane of a triangle. */
struct plane {
	float edges[2][3];         /* from its first corner */
	float normal[3], squared;  /* as long as twice the area; 0: it has none */
	float along[3], across[3]; /* unit vectors in it */
};

static void plane_of(struct plane *out, const struct mesh *scan, uint32_t triangle)
{
	const uint32_t *corners = scan->triangles[triangle];

	for (int i = 0; i < 2; i++)
		vec_sub(out->edges[i], scan->positions[corners[i + 1]],
			scan->positions[corners[0]]);
	vec_cross(out->normal, out->edges[0], out->edges[1]);
	out->squared = vec_dot(out->normal, out->normal);
	vec_copy(out->along, out->edges[0]);
	vec_normalise(out->along);
	vec_cross(out->across, out->normal, out->along);
	vec_normalise(out->across);
}

/* The mean of places on the triangle, and in a square as wide as a cube. Beside the triangle, its
 * picture may show anything. */
static void colour_of_texture(uint8_t out[3], const struct transferring *all,
			      const struct triangle_place *place)
{
	enum { SIDE = 5 };
	float sum[4] = { 0 };
	struct plane plane;

	plane_of(&plane, all->scan, place->triangle);
	add_texel(sum, all->scan, place->triangle, place->shares);
	for (int i = 0; i < SIDE * SIDE && plane.squared > 0; i++) {
		const float x = all->cell_m * (((float)(i % SIDE) + 0.5f) / SIDE - 0.5f);
		const float y = all->cell_m * (((float)(i / SIDE) + 0.5f) / SIDE - 0.5f);
		float shares[3], off[3], cross[3];

		memcpy(shares, place->shares, sizeof(shares));
		for (int k = 0; k < 3; k++)
			off[k] = x * plane.along[k] + y * plane.across[k];
		vec_cross(cross, off, plane.edges[1]);
		shares[1] += vec_dot(cross, plane.normal) / plane.squared;
		vec_cross(cross, plane.edges[0], off);
		shares[2] += vec_dot(cross, plane.normal) / plane.squared;
		shares[0] = 1 - shares[1] - shares[2];
		if (shares[0] >= 0 && shares[1] >= 0 && shares[2] >= 0)
			add_texel(sum, all->scan, place->triangle, shares);
	}
	for (int k = 0; k < 3; k++)
		out[k] = (uint8_t)(sum[k] / sum[3] + 0.5f);
}

static int colour_vertices(void *user, uint32_t first, uint32_t after, uint32_t worker)
{
	const struct transferring *all = user;
	const struct mesh *scan = all->scan;

	(void)worker;
	for (uint32_t v = first; v < after; v++) {
		uint8_t *colour = all->out->colours[v];
		struct triangle_place place = { .shares = { 1, 0, 0 } };

		if (!triangle_tree_nearest(all->tree, all->out->positions[v], INFINITY, &place))
			continue;
		for (int k = 0; k < 4; k++) {
			float mixed = 0.5f;

			for (int i = 0; i < 3; i++)
				mixed += place.shares[i] *
					 scan->colours[scan->triangles[place.triangle][i]][k];
			colour[k] = (uint8_t)vec_least(255, mixed);
		}
		if (scan->textures)
			colour_of_texture(colour, all, &place);
	}
	spill_breathe();
	return 0;
}

static int colour(struct transferring *all)
{
	struct mesh *out = all->out;

	if (!all->scan->colours)
		return 0;
	out->colours = spill_alloc((out->vertex_count + (size_t)1) * sizeof(*out->colours));
	return out->colours ? parallel_ranges(parallel_cores(), out->vertex_count, RANGE_ITEMS,
					      colour_vertices, all)
			    : -errno;
}

/* ---- faces */

static int find_sources(void *user, uint32_t first, uint32_t after, uint32_t worker)
{
	const struct transferring *all = user;
	const struct mesh *out = all->out;

	(void)worker;
	for (uint32_t t = first; t < after; t++) {
		struct triangle_place place = { 0 };
		float middle[3] = { 0 };

		for (int i = 0; i < 3; i++)
			vec_add_scaled(middle, middle, 1.0f / 3,
				       out->positions[out->triangles[t][i]]);
		if (triangle_tree_nearest(all->tree, middle, INFINITY, &place))
			all->sources[t] = place.triangle;
	}
	spill_breathe();
	return 0;
}

/* Returns the scan that a triangle is of. ends: where the triangles of each end. */
static uint32_t scan_of(const uint32_t *ends, uint32_t count, uint32_t triangle)
{
	uint32_t low = 0, high = count - 1;

	while (low < high) {
		const uint32_t middle = (low + high) / 2;

		if (triangle < ends[middle])
			high = middle;
		else
			low = middle + 1;
	}
	return low;
}

/* Sorts the triangles by scans, and takes over the numbers of faces. */
static int order_triangles(const struct transferring *all)
{
	const struct mesh *scan = all->scan;
	struct mesh *out = all->out;
	const size_t room = out->triangle_count + (size_t)1;
	uint32_t(*triangles)[3] = spill_alloc(room * sizeof(*triangles));
	uint32_t ends[MESH_SCANS_MAX], next[MESH_SCANS_MAX + 1] = { 0 };

	if (triangles && scan->faces)
		out->faces = spill_alloc(room * sizeof(*out->faces));
	if (!triangles || (scan->faces && !out->faces)) {
		spill_free(triangles);
		return -errno;
	}
	for (uint32_t s = 0; s < scan->scan_count; s++)
		ends[s] = scan->scans[s].triangle_count + (s > 0 ? ends[s - 1] : 0);
	for (uint32_t t = 0; t < out->triangle_count; t++)
		out->scans[scan_of(ends, scan->scan_count, all->sources[t])].triangle_count++;
	for (uint32_t s = 0; s < scan->scan_count; s++)
		next[s + 1] = next[s] + out->scans[s].triangle_count;
	for (uint32_t t = 0; t < out->triangle_count; t++) {
		const uint32_t source = all->sources[t];
		const uint32_t to = next[scan_of(ends, scan->scan_count, source)]++;

		memcpy(triangles[to], out->triangles[t], sizeof(triangles[to]));
		if (scan->faces)
			out->faces[to] = scan->faces[source];
		spill_pass(t);
	}
	spill_free(out->triangles);
	out->triangles = triangles;
	return 0;
}

static int take_faces(struct transferring *all)
{
	struct mesh *out = all->out;
	int rc;

	if (all->scan->scan_count == 0)
		return 0;
	out->scan_count = all->scan->scan_count;
	for (uint32_t s = 0; s < out->scan_count; s++)
		out->scans[s] = (struct mesh_scan){ .face_count = all->scan->scans[s].face_count };
	all->sources = spill_alloc((out->triangle_count + (size_t)1) * sizeof(*all->sources));
	rc = all->sources ? parallel_ranges(parallel_cores(), out->triangle_count, RANGE_ITEMS,
					    find_sources, all)
			  : -errno;
	if (rc == 0)
		rc = order_triangles(all);
	spill_free(all->sources);
	return rc;
}

int scan_transfer(struct mesh *out, const struct mesh *scan, const struct triangle_tree *tree,
		  float cell_m)
{
	struct transferring all = { .out = out, .scan = scan, .tree = tree, .cell_m = cell_m };
	const int rc = colour(&all);

	return rc == 0 ? take_faces(&all) : rc;
}
