/* Splits vertices at seams of materials, and simplifies. */
#include "pipeline/texmesh/reduced_mesh.h"

#include <errno.h>
#include <limits.h>
#include <meshoptimizer.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/spill.h"
#include "geometry/vec.h"
#include "pipeline/material/material.h"

/* Relative to the model's size: the number of triangles decides alone. */
static const float error_most = 1e9f;

/* A corner as two triangles may share it. */
struct corner {
	float position[3], uv[2];
	uint32_t material;
};

void reduced_mesh_finish(struct reduced_mesh *mesh)
{
	if (!mesh)
		return;
	free(mesh->positions);
	free(mesh->normals);
	free(mesh->uvs);
	free(mesh->colours);
	free(mesh->origins);
	free(mesh->triangles);
	free(mesh->materials);
	free(mesh->firsts);
	memset(mesh, 0, sizeof(*mesh));
}

/* Room for vertices and triangles, and for what like has: uvs with materials, or colours. */
static int allocate(struct reduced_mesh *out, const struct reduced_mesh *like, uint32_t vertices,
		    uint32_t triangles)
{
	const size_t v = (size_t)vertices + 1, t = (size_t)triangles + 1;

	*out = (struct reduced_mesh){ .vertex_count = vertices,
				      .triangle_count = triangles,
				      .material_count = like->material_count };
	memcpy(out->colour, like->colour, sizeof(out->colour));
	out->positions = malloc(v * sizeof(*out->positions));
	out->normals = calloc(v, sizeof(*out->normals));
	out->triangles = malloc(t * sizeof(*out->triangles));
	out->origins = malloc(v * sizeof(*out->origins));
	out->firsts = calloc((size_t)like->material_count + 2, sizeof(*out->firsts));
	if (like->uvs) {
		out->uvs = malloc(v * sizeof(*out->uvs));
		out->materials = malloc(v * sizeof(*out->materials));
	}
	if (like->colours)
		out->colours = malloc(v * sizeof(*out->colours));
	if (out->positions && out->normals && out->triangles && out->origins && out->firsts &&
	    !out->uvs == !like->uvs && !out->materials == !like->uvs &&
	    !out->colours == !like->colours)
		return 0;
	reduced_mesh_finish(out);
	return -ENOMEM;
}

/* ---- the whole scan */

/* Vertices of a scan with textures: a corner that two materials share becomes two. */
static int copy_textured(struct reduced_mesh *out, const struct mesh *mesh)
{
	const struct reduced_mesh like = { .uvs = mesh->uvs,
					   .material_count = mesh->texture_count };
	const size_t count = 3 * (size_t)mesh->triangle_count;
	struct corner *corners = calloc(count + 1, sizeof(*corners));
	unsigned *remap = malloc((count + 1) * sizeof(*remap));
	uint32_t vertices;
	int rc = corners && remap ? 0 : -ENOMEM;

	for (size_t i = 0; rc == 0 && i < count; i++) {
		const uint32_t v = mesh->triangles[i / 3][i % 3];

		vec_copy(corners[i].position, mesh->positions[v]);
		memcpy(corners[i].uv, mesh->uvs[v], sizeof(corners[i].uv));
		corners[i].material = mesh->materials ? mesh->materials[i / 3] : 0;
		spill_pass(i);
	}
	if (rc == 0) {
		vertices = (uint32_t)meshopt_generateVertexRemap(remap, NULL, count, corners, count,
								 sizeof(*corners));
		rc = allocate(out, &like, vertices, mesh->triangle_count);
	}
	for (size_t i = 0; rc == 0 && i < count; i++) {
		const uint32_t v = remap[i];

		vec_copy(out->positions[v], corners[i].position);
		memcpy(out->uvs[v], corners[i].uv, sizeof(out->uvs[v]));
		out->materials[v] = (uint16_t)corners[i].material;
		out->triangles[i / 3][i % 3] = v;
	}
	free(corners);
	free(remap);
	return rc;
}

/* Returns whether vertices differ in colour. */
static bool has_colours(const struct mesh *mesh)
{
	for (uint32_t i = 1; mesh->colours && i < mesh->vertex_count; i++) {
		if (memcmp(mesh->colours[i], mesh->colours[0], 3) != 0)
			return true;
		spill_pass(i);
	}
	return false;
}

/* keeps_colours: vertices have colours of their own in out. */
static int copy_plain(struct reduced_mesh *out, const struct mesh *mesh, bool keeps_colours)
{
	const struct reduced_mesh like = { .colours = keeps_colours ? mesh->colours : NULL,
					   .colour = { 255, 255, 255 },
					   .material_count = 1 };
	int rc = allocate(out, &like, mesh->vertex_count, mesh->triangle_count);

	if (rc == 0 && mesh->colours)
		memcpy(out->colour, mesh->colours[0], sizeof(out->colour));
	for (uint32_t i = 0; rc == 0 && i < mesh->vertex_count; i++) {
		vec_copy(out->positions[i], mesh->positions[i]);
		if (out->colours)
			memcpy(out->colours[i], mesh->colours[i], sizeof(out->colours[i]));
		spill_pass(i);
	}
	for (uint32_t i = 0; rc == 0 && i < mesh->triangle_count; i++) {
		memcpy(out->triangles[i], mesh->triangles[i], sizeof(out->triangles[i]));
		spill_pass(i);
	}
	return rc;
}

/* The mean length of the edges. */
static float spacing_of(const struct reduced_mesh *mesh)
{
	double sum = 0;

	for (uint32_t i = 0; i < mesh->triangle_count; i++) {
		const uint32_t *t = mesh->triangles[i];

		for (int k = 0; k < 3; k++)
			sum += (double)vec_distance(mesh->positions[t[k]],
						    mesh->positions[t[(k + 1) % 3]]);
	}
	return (float)(sum / (3.0 * mesh->triangle_count));
}

/* Gives vertices the colours of a substance, without the detail that is finer than they are. The
 * share of open sky stays. */
static void paint(struct reduced_mesh *mesh, enum substance_kind substance)
{
	const float spacing_m = spacing_of(mesh);

	for (uint32_t i = 0; i < mesh->vertex_count; i++) {
		float rgb[3];

		if (substance == SUBSTANCE_NONE)
			material_colour(rgb, mesh->positions[i], mesh->normals[i], spacing_m);
		else
			substance_colour(rgb, substance, mesh->positions[i], spacing_m);
		for (int k = 0; k < 3; k++)
			mesh->colours[i][k] =
				(uint8_t)(255 * vec_least(vec_most(rgb[k], 0), 1) + 0.5f);
	}
}

/* Normals are the same on both sides of a seam: they are summed by place. */
static int find_normals(struct reduced_mesh *mesh)
{
	const size_t count = mesh->vertex_count;
	unsigned *place = malloc((count + 1) * sizeof(*place));
	float(*sums)[3] = calloc(count + 1, sizeof(*sums));
	const int rc = place && sums ? 0 : -ENOMEM;

	if (rc == 0)
		meshopt_generateVertexRemap(place, NULL, count, mesh->positions, count,
					    sizeof(*mesh->positions));
	for (uint32_t i = 0; rc == 0 && i < mesh->triangle_count; i++) {
		const uint32_t *t = mesh->triangles[i];
		float a[3], b[3], normal[3]; /* as long as twice the area */

		vec_sub(a, mesh->positions[t[1]], mesh->positions[t[0]]);
		vec_sub(b, mesh->positions[t[2]], mesh->positions[t[0]]);
		vec_cross(normal, a, b);
		for (int k = 0; k < 3; k++)
			vec_add(sums[place[t[k]]], sums[place[t[k]]], normal);
	}
	for (uint32_t i = 0; rc == 0 && i < mesh->vertex_count; i++) {
		vec_copy(mesh->normals[i], sums[place[i]]);
		if (vec_length(mesh->normals[i]) > 0)
			vec_normalise(mesh->normals[i]);
		else
			mesh->normals[i][2] = 1;
	}
	free(place);
	free(sums);
	return rc;
}

int reduced_mesh_copy(struct reduced_mesh *out, const struct mesh *mesh, struct reduced_look look)
{
	const bool has_textures = mesh->uvs && mesh->texture_count > 0 && !look.is_stone;
	int rc;

	*out = (struct reduced_mesh){ 0 };
	if (3 * (uint64_t)mesh->triangle_count > INT_MAX)
		return -EFBIG;
	rc = has_textures ? copy_textured(out, mesh)
			  : copy_plain(out, mesh, look.is_stone || has_colours(mesh));
	if (rc == 0)
		rc = find_normals(out);
	if (rc == 0 && look.is_stone)
		paint(out, look.substance);
	if (rc < 0)
		reduced_mesh_finish(out);
	return rc;
}

/* ---- fewer triangles */

/* Sorts triangles by the texture of their vertices, and sets firsts. */
static void sort_by_material(struct reduced_mesh *out, const struct reduced_mesh *whole,
			     const uint32_t *indices, uint32_t count)
{
	uint32_t *firsts = out->firsts;

	for (uint32_t i = 0; i < count; i++)
		firsts[(whole->materials ? whole->materials[indices[3 * i]] : 0) + 2]++;
	for (uint32_t m = 0; m < whole->material_count; m++)
		firsts[m + 2] += firsts[m + 1];
	for (uint32_t i = 0; i < count; i++) {
		const uint32_t m = whole->materials ? whole->materials[indices[3 * i]] : 0;

		memcpy(out->triangles[firsts[m + 1]++], &indices[3 * i], sizeof(*out->triangles));
	}
}

/* Orders triangles for the GPU's cache and drops vertices that none uses. */
static int compact(struct reduced_mesh *out, const struct reduced_mesh *whole)
{
	const size_t count = 3 * (size_t)out->triangle_count;
	unsigned *remap = malloc(((size_t)whole->vertex_count + 1) * sizeof(*remap));

	if (!remap)
		return -ENOMEM;
	for (uint32_t m = 0; m < out->material_count; m++) {
		uint32_t *first = out->triangles[out->firsts[m]];
		const size_t corners = 3 * (size_t)(out->firsts[m + 1] - out->firsts[m]);

		if (corners > 0)
			meshopt_optimizeVertexCache(first, first, corners, whole->vertex_count);
	}
	out->vertex_count = (uint32_t)meshopt_optimizeVertexFetchRemap(remap, out->triangles[0],
								       count, whole->vertex_count);
	meshopt_remapIndexBuffer(out->triangles[0], out->triangles[0], count, remap);
	for (uint32_t i = 0; i < whole->vertex_count; i++) {
		const unsigned to = remap[i];

		if (to == ~0u)
			continue;
		vec_copy(out->positions[to], whole->positions[i]);
		vec_copy(out->normals[to], whole->normals[i]);
		out->origins[to] = i;
		if (out->uvs) {
			memcpy(out->uvs[to], whole->uvs[i], sizeof(out->uvs[to]));
			out->materials[to] = whole->materials[i];
		}
		if (out->colours)
			memcpy(out->colours[to], whole->colours[i], sizeof(out->colours[to]));
	}
	free(remap);
	return 0;
}

int reduced_mesh_make(struct reduced_mesh *out, const struct reduced_mesh *whole,
		      uint32_t triangle_count)
{
	const size_t corners = 3 * (size_t)whole->triangle_count;
	uint32_t *indices = malloc((corners + 1) * sizeof(*indices));
	size_t left = corners;
	int rc = indices ? 0 : -ENOMEM;

	*out = (struct reduced_mesh){ 0 };
	if (rc == 0) {
		memcpy(indices, whole->triangles, corners * sizeof(*indices));
		if (triangle_count < whole->triangle_count)
			left = meshopt_simplify(indices, whole->triangles[0], corners,
						whole->positions[0], whole->vertex_count,
						sizeof(*whole->positions),
						3 * (size_t)triangle_count, error_most, 0, NULL);
		rc = allocate(out, whole, whole->vertex_count, (uint32_t)(left / 3));
	}
	if (rc == 0) {
		sort_by_material(out, whole, indices, out->triangle_count);
		rc = compact(out, whole);
	}
	free(indices);
	if (rc < 0)
		reduced_mesh_finish(out);
	return rc;
}
