/* Converts between the surface in the unit of the files and the steps of the octree. */
#include "pipeline/octree/budget_mesh.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"

/* Cubes begin a little below 0; a multiple of a large power of two, so that the nodes of the octree
 * lie alike in every model. */
enum { LOD_SHIFT = 64 };

int budget_leaf_add(void *data, const int32_t cube[3], uint8_t inside,
		    const uint32_t vertices[CUBE_EDGES])
{
	struct budget_leaves *leaves = data;
	struct lod_leaf leaf = { .inside = inside };
	int rc = ARRAY_RESERVE(leaves->items, leaves->room, leaves->count + 1ull, LOD_NONE - 1);

	for (int k = 0; k < 3; k++) {
		if (cube[k] < -LOD_SHIFT || cube[k] >= (1 << 20))
			return -EFBIG;
		leaf.cube[k] = (uint32_t)(cube[k] + LOD_SHIFT);
	}
	memcpy(leaf.vertices, vertices, sizeof(leaf.vertices));
	if (rc == 0)
		leaves->items[leaves->count++] = leaf;
	return rc;
}

void budget_leaves_finish(struct budget_leaves *leaves)
{
	if (!leaves)
		return;
	free(leaves->items);
	*leaves = (struct budget_leaves){ 0 };
}

int budget_model_create(struct lod_model *out, struct budget_leaves *leaves,
			const struct mesh *mesh, const struct reconstruct_report *report)
{
	struct lod_vertex *vertices = malloc((mesh->vertex_count + (size_t)1) * sizeof(*vertices));

	*out = (struct lod_model){ 0 };
	if (!vertices)
		return -ENOMEM;
	for (uint32_t i = 0; i < mesh->vertex_count; i++) {
		for (int k = 0; k < 3; k++) {
			const double cubes =
				((double)mesh->positions[i][k] - report->low[k]) / report->cell;

			vertices[i].place[k] = (int32_t)lrint(LOD_CUBE_STEPS * cubes);
		}
		memset(vertices[i].colour, 255, sizeof(vertices[i].colour));
		if (mesh->colours)
			memcpy(vertices[i].colour, mesh->colours[i], sizeof(vertices[i].colour));
	}
	return lod_model_create(out, leaves->items, leaves->count, vertices, mesh->vertex_count);
}

static int take_mesh(struct mesh *out, const struct lod_mesh *made,
		     const struct reconstruct_report *report, bool has_colour)
{
	out->positions = malloc((made->vertex_count + (size_t)1) * sizeof(*out->positions));
	out->triangles = malloc((made->triangle_count + (size_t)1) * sizeof(*out->triangles));
	if (has_colour)
		out->colours = malloc((made->vertex_count + (size_t)1) * sizeof(*out->colours));
	if (!out->positions || !out->triangles || (has_colour && !out->colours))
		return -ENOMEM;
	out->vertex_count = made->vertex_count;
	out->triangle_count = made->triangle_count;
	memcpy(out->triangles, made->triangles, made->triangle_count * sizeof(*out->triangles));
	for (uint32_t i = 0; i < made->vertex_count; i++) {
		for (int k = 0; k < 3; k++)
			out->positions[i][k] =
				(float)(report->low[k] +
					report->cell / LOD_CUBE_STEPS * made->vertices[i].place[k]);
		if (has_colour)
			memcpy(out->colours[i], made->vertices[i].colour, sizeof(*out->colours));
	}
	return 0;
}

int budget_mesh_make(struct mesh *out, struct lod_model *model,
		     const struct reconstruct_report *report, bool has_colour, uint32_t triangles)
{
	struct lod_mesh made = { 0 };
	int rc = lod_mesh_make(&made, model, triangles);

	*out = (struct mesh){ 0 };
	if (rc == 0 && made.triangle_count == 0)
		rc = -ENODATA;
	if (rc == 0)
		rc = take_mesh(out, &made, report, has_colour);
	lod_mesh_finish(&made);
	if (rc < 0)
		mesh_finish(out);
	return rc;
}
