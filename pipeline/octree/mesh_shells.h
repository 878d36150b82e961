/* The shells of a mesh, which are its faces joined across edges of two faces, and which of them are
 * inside out. A scan that was put together by hand has tens of thousands, each turned as whoever
 * made it left it. */
#ifndef GOPURA_PIPELINE_OCTREE_MESH_SHELLS_H
#define GOPURA_PIPELINE_OCTREE_MESH_SHELLS_H

#include "pipeline/import/mesh.h"
#include "pipeline/octree/triangle_tree.h"

struct mesh_shells {
	uint32_t count;
	uint32_t *first;     /* of each shell, and one more: where its triangles begin; owned */
	uint32_t *triangles; /* numbers in the mesh, shell by shell; owned */
	uint8_t *is_open;    /* of each shell: it has an edge of other than two faces; owned */
};

/* Removes each triangle that has the same three places as an earlier one, on whichever side,
 * because a surface that is there twice has no edge of two faces. The order of the others is kept.
 * *removed: how many. -ENOMEM, -ENOSPC: nothing changed. */
must_check int mesh_drop_copies(struct mesh *mesh, uint32_t *removed);

/* *out is owned by the caller; zeroed on failure. -ENOMEM, -ENOSPC. */
must_check int mesh_shells_find(struct mesh_shells *out, const struct mesh *mesh);
void mesh_shells_finish(struct mesh_shells *shells); /* NULL and zeroed are fine */

/* Finds the shells that are inside out. A shell without an open edge is, if it encloses a volume
 * below 0. An open one is, if most of its faces look at its middle and rays escape from their backs
 * and few from their fronts; a scan mostly shows the side that was seen, so it is turned only on
 * such evidence. Sets turned[i], which has room for each
 * triangle of the mesh, to 1 or 0, and *count to how many shells. tree is of the same mesh; away:
 * how far from a face rays begin. -ENOMEM. */
must_check int mesh_shells_judge(uint8_t *turned, uint32_t *count, const struct mesh_shells *shells,
				 const struct mesh *mesh, const struct triangle_tree *tree,
				 float away);

#endif
