/* Joins reconstruct and the octree: collects the leaf cubes of a closed surface, and gives a mesh
 * of any number of triangles in the unit of the files. */
#ifndef GOPURA_PIPELINE_OCTREE_BUDGET_MESH_H
#define GOPURA_PIPELINE_OCTREE_BUDGET_MESH_H

#include "pipeline/octree/lod_mesh.h"
#include "pipeline/octree/reconstruct.h"

struct budget_leaves {
	struct lod_leaf *items; /* owned; their cubes are shifted so that none is below 0 */
	uint32_t count, room;
};

/* For struct reconstruct_options: leaf, where data is a zeroed struct budget_leaves. -ENOMEM,
 * -EFBIG.
 */
int budget_leaf_add(void *data, const int32_t cube[3], uint8_t inside,
		    const uint32_t vertices[CUBE_EDGES]);
void budget_leaves_finish(struct budget_leaves *leaves); /* NULL and zeroed are fine */

/* Prepares a model of the surface that reconstruct made with is_closed and these leaves. Errors as
 * lod_model_create. */
must_check int budget_model_create(struct lod_model *out, struct budget_leaves *leaves,
				   const struct mesh *mesh,
				   const struct reconstruct_report *report);
/* Makes a mesh of at most `triangles` triangles; *out is owned by the caller (mesh_finish), and
 * zeroed on failure. has_colour: keep the colours. -ENODATA: fewer than the coarsest surface has.
 * -ENOMEM. */
must_check int budget_mesh_make(struct mesh *out, struct lod_model *model,
				const struct reconstruct_report *report, bool has_colour,
				uint32_t triangles);

#endif
