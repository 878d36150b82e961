/* Finds shells by union-find over the faces, and judges each by its volume or by rays. */
#include "pipeline/octree/mesh_shells.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "base/parallel.h"
#include "base/spill.h"
#include "geometry/vec.h"
#include "pipeline/import/mesh_edges.h"
#include "pipeline/import/mesh_places.h"

/* ---- copies */

static void sorted_places(uint32_t out[3], const struct mesh *mesh, const uint32_t *place,
			  uint32_t triangle)
{
	for (int i = 0; i < 3; i++) {
		const uint32_t vertex = mesh->triangles[triangle][i];
		const uint32_t added = place ? place[vertex] : vertex;
		int at = i;

		for (; at > 0 && out[at - 1] > added; at--)
			out[at] = out[at - 1];
		out[at] = added;
	}
}

/* Marks in `copies` the triangles that have an earlier equal one. `heads` has room for each vertex,
 * `next` for each triangle: lists of those with the same lowest vertex. */
static uint32_t mark_copies(const struct mesh *mesh, const uint32_t *place, uint32_t *heads,
			    uint32_t *next, uint8_t *copies)
{
	uint32_t count = 0;

	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		uint32_t own[3], other[3], at;

		spill_pass(t);
		sorted_places(own, mesh, place, t);
		/* lists hold numbers plus 1 */
		for (at = heads[own[0]]; at > 0; at = next[at - 1]) {
			sorted_places(other, mesh, place, at - 1);
			if (memcmp(own, other, sizeof(own)) == 0)
				break;
		}
		copies[t] = at > 0;
		count += at > 0;
		if (at > 0)
			continue;
		next[t] = heads[own[0]];
		heads[own[0]] = t + 1;
	}
	return count;
}

static void drop_marked(struct mesh *mesh, const uint8_t *copies)
{
	uint32_t kept = 0, scan = 0, end = mesh->scans[0].triangle_count;

	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		spill_pass(t);
		while (t >= end && scan + 1 < mesh->scan_count)
			end += mesh->scans[++scan].triangle_count;
		if (copies[t]) {
			mesh->scans[scan].triangle_count -= mesh->scan_count > 0;
			continue;
		}
		memmove(mesh->triangles[kept], mesh->triangles[t], sizeof(mesh->triangles[0]));
		if (mesh->materials)
			mesh->materials[kept] = mesh->materials[t];
		if (mesh->faces)
			mesh->faces[kept] = mesh->faces[t];
		kept++;
	}
	mesh->triangle_count = kept;
}

int mesh_drop_copies(struct mesh *mesh, uint32_t *removed)
{
	const size_t count = mesh->triangle_count + (size_t)1;
	uint32_t *place = NULL;
	uint32_t *heads = spill_alloc((mesh->vertex_count + (size_t)1) * sizeof(*heads));
	uint32_t *next = heads ? spill_alloc(count * sizeof(*next)) : NULL;
	uint8_t *copies = next ? spill_alloc(count) : NULL;
	int rc = copies ? mesh_places(&place, mesh, parallel_cores()) : -errno;

	*removed = 0;
	if (rc == 0)
		*removed = mark_copies(mesh, place, heads, next, copies);
	if (*removed > 0)
		drop_marked(mesh, copies);
	spill_free(place);
	spill_free(heads);
	spill_free(next);
	spill_free(copies);
	return rc;
}

/* ---- shells */

struct finding {
	uint32_t *parents; /* of each triangle, up to the root of its shell */
	uint8_t *is_open;  /* of each triangle */
};

static uint32_t root_of(uint32_t *parents, uint32_t triangle)
{
	while (parents[triangle] != triangle) {
		parents[triangle] = parents[parents[triangle]];
		triangle = parents[triangle];
	}
	return triangle;
}

static void join(void *data, const struct mesh_edge *edge)
{
	struct finding *finding = data;
	uint32_t a, b;

	if (edge->face_count != 2 || edge->turned) {
		for (uint32_t i = 0; i < edge->face_count && i < 2; i++)
			finding->is_open[edge->faces[i]] = 1;
		return;
	}
	a = root_of(finding->parents, edge->faces[0]);
	b = root_of(finding->parents, edge->faces[1]);
	finding->parents[a > b ? a : b] = a < b ? a : b;
}

/* Numbers the shells in the order of their first triangles, and lists their triangles. A root is
 * the lowest triangle of its shell. `numbers` has room for each triangle. */
static int list_shells(struct mesh_shells *out, struct finding *finding, uint32_t triangles,
		       uint32_t *numbers)
{
	for (uint32_t t = 0; t < triangles; t++) {
		const uint32_t root = root_of(finding->parents, t);

		numbers[t] = root == t ? out->count++ : numbers[root];
		spill_pass(t);
	}
	out->first = spill_alloc((out->count + (size_t)2) * sizeof(*out->first));
	out->is_open = out->first ? spill_alloc(out->count + (size_t)1) : NULL;
	out->triangles = out->is_open
				 ? spill_alloc((triangles + (size_t)1) * sizeof(*out->triangles))
				 : NULL;
	if (!out->triangles)
		return -errno;
	/* first[s + 2] counts those of s; then first[s + 1] is where the next one of s goes */
	for (uint32_t t = 0; t < triangles; t++) {
		out->first[numbers[t] + 2]++;
		out->is_open[numbers[t]] |= finding->is_open[t];
	}
	for (uint32_t s = 2; s <= out->count; s++)
		out->first[s] += out->first[s - 1];
	for (uint32_t t = 0; t < triangles; t++) {
		out->triangles[out->first[numbers[t] + 1]++] = t;
		spill_pass(t);
	}
	return 0;
}

int mesh_shells_find(struct mesh_shells *out, const struct mesh *mesh)
{
	const size_t count = mesh->triangle_count + (size_t)1;
	struct finding finding = { spill_alloc(count * sizeof(uint32_t)), spill_alloc(count) };
	uint32_t *numbers = spill_alloc(count * sizeof(*numbers));
	struct mesh_edges edges = { 0 };
	int rc = finding.parents && finding.is_open && numbers ? 0 : -errno;

	*out = (struct mesh_shells){ 0 };
	for (uint32_t t = 0; t < mesh->triangle_count && rc == 0; t++)
		finding.parents[t] = t;
	if (rc == 0)
		rc = mesh_edges_init(&edges, mesh, parallel_cores());
	if (rc == 0)
		rc = mesh_edges_each(&edges, join, &finding);
	mesh_edges_finish(&edges);
	if (rc == 0)
		rc = list_shells(out, &finding, mesh->triangle_count, numbers);
	spill_free(finding.parents);
	spill_free(finding.is_open);
	spill_free(numbers);
	if (rc < 0)
		mesh_shells_finish(out);
	return rc;
}

void mesh_shells_finish(struct mesh_shells *shells)
{
	if (!shells)
		return;
	spill_free(shells->first);
	spill_free(shells->triangles);
	spill_free(shells->is_open);
	*shells = (struct mesh_shells){ 0 };
}

/* ---- judging */

enum { RANGE_SHELLS = 64, TRIED_TRIANGLES = 24, DIRECTIONS = 4 };

/* An open shell that is less round is a sheet, such as a ceiling or the ground; it shows the side
 * that was scanned. */
static const double hollow = 0.1;
/* One that is so round must be a body with small holes; a cube has 0.72, half of one 0.38. */
static const double nearly_closed = 0.5;

struct judging {
	const struct mesh_shells *shells;
	const struct mesh *mesh;
	const struct triangle_tree *tree;
	float away;
	uint8_t *turned;
	uint32_t counts[64]; /* of each worker */
};

static void corners_of(const float *out[3], const struct mesh *mesh, uint32_t triangle)
{
	for (int i = 0; i < 3; i++)
		out[i] = mesh->positions[mesh->triangles[triangle][i]];
}

/* Returns the volume between a shell and its middle: of a ball 1, whatever its size; of a flat
 * sheet 0; below 0 if most faces look at the middle. */
static double roundness_of(const struct judging *judging, uint32_t first, uint32_t after)
{
	const struct mesh_shells *shells = judging->shells;
	double middle[3] = { 0 }, volume6 = 0, area2 = 0;
	const float *corners[3];

	for (uint32_t i = first; i < after; i++) {
		corners_of(corners, judging->mesh, shells->triangles[i]);
		for (int k = 0; k < 3; k++)
			middle[k] += ((double)corners[0][k] + (double)corners[1][k] +
				      (double)corners[2][k]) /
				     (3.0 * (after - first));
	}
	for (uint32_t i = first; i < after; i++) {
		double p[3][3], normal[3];

		corners_of(corners, judging->mesh, shells->triangles[i]);
		for (int c = 0; c < 3; c++)
			for (int k = 0; k < 3; k++)
				p[c][k] =
					(double)corners[c][k] - (c > 0 ? (double)corners[0][k] : 0);
		for (int k = 0; k < 3; k++) {
			normal[k] = p[1][(k + 1) % 3] * p[2][(k + 2) % 3] -
				    p[1][(k + 2) % 3] * p[2][(k + 1) % 3];
			volume6 += (p[0][k] - middle[k]) * normal[k];
		}
		area2 +=
			sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
	}
	/* a ball of radius 1 has 6 volumes of 8 pi, and twice the area of 8 pi */
	return area2 > 0 ? volume6 / (8 * 3.14159265) * pow(8 * 3.14159265 / area2, 1.5) : 0;
}

/* Returns how many rays from one side of a triangle escape: along `normal`, and three that are
 * tilted from it. */
static int escapes(const struct judging *judging, const float *const corners[3],
		   const float normal[3])
{
	float from[3], towards[3], across[3], aside[3];
	int count = 0;

	for (int k = 0; k < 3; k++)
		from[k] = (corners[0][k] + corners[1][k] + corners[2][k]) / 3 +
			  judging->away * normal[k];
	vec_sub(across, corners[1], corners[0]);
	vec_normalise(across);
	vec_cross(aside, normal, across);
	for (int d = 0; d < DIRECTIONS; d++) {
		const float turn = 2.0944f * (float)d;

		for (int k = 0; k < 3; k++)
			towards[k] =
				d == 0 ? normal[k]
				       : normal[k] + across[k] * cosf(turn) + aside[k] * sinf(turn);
		count += triangle_tree_crossings(judging->tree, from, towards, 1) == 0;
	}
	return count;
}

/* Compares, of some triangles, the rays that escape from the backs with those from the fronts.
 * Returns 1 if every sixth does, and twice as many; 0 if hardly any does from either; else -1. */
static int escapes_behind(const struct judging *judging, uint32_t first, uint32_t after)
{
	const uint32_t step = (after - first - 1) / TRIED_TRIANGLES + 1;
	int in_front = 0, behind = 0, all = 0;

	for (uint32_t i = first; i < after; i += step) {
		const float *corners[3];
		float a[3], b[3], normal[3], back[3];

		corners_of(corners, judging->mesh, judging->shells->triangles[i]);
		vec_sub(a, corners[1], corners[0]);
		vec_sub(b, corners[2], corners[0]);
		vec_cross(normal, a, b);
		if (!(vec_normalise(normal) > 0))
			continue;
		vec_scale(back, -1, normal);
		in_front += escapes(judging, corners, normal);
		behind += escapes(judging, corners, back);
		all += DIRECTIONS;
	}
	if (5 * (behind + in_front) < all)
		return 0;
	return 6 * behind > all && behind > 2 * in_front ? 1 : -1;
}

static bool is_inside_out(const struct judging *judging, uint32_t shell)
{
	const uint32_t first = judging->shells->first[shell];
	const uint32_t after = judging->shells->first[shell + 1];
	const double roundness = roundness_of(judging, first, after);

	int seen;

	if (!judging->shells->is_open[shell] || !(roundness < -hollow))
		return !judging->shells->is_open[shell] && roundness < 0;
	seen = escapes_behind(judging, first, after);
	return seen > 0 || (seen == 0 && roundness < -nearly_closed);
}

static int judge_shells(void *user, uint32_t first_shell, uint32_t after_shell, uint32_t worker)
{
	struct judging *judging = user;
	const struct mesh_shells *shells = judging->shells;

	for (uint32_t s = first_shell; s < after_shell; s++) {
		const bool is_turned = is_inside_out(judging, s);

		for (uint32_t i = shells->first[s]; i < shells->first[s + 1]; i++)
			judging->turned[shells->triangles[i]] = is_turned;
		judging->counts[worker] += is_turned;
	}
	spill_breathe();
	return 0;
}

int mesh_shells_judge(uint8_t *turned, uint32_t *count, const struct mesh_shells *shells,
		      const struct mesh *mesh, const struct triangle_tree *tree, float away)
{
	struct judging judging = {
		.shells = shells, .mesh = mesh, .tree = tree, .away = away, .turned = turned
	};
	const int rc = parallel_ranges(parallel_cores(), shells->count, RANGE_SHELLS, judge_shells,
				       &judging);

	*count = 0;
	for (uint32_t i = 0; i < 64; i++)
		*count += judging.counts[i];
	return rc;
}
