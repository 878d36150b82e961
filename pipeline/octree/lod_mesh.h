/* A mesh of at most so many triangles from the octree (paper P1, chapter 6): the LOD array is
 * walked backwards, and of each opened node those children are drawn that are not opened
 * themselves. Takes time in proportion to the number of triangles, and computes only with whole
 * numbers. */
#ifndef GOPURA_PIPELINE_OCTREE_LOD_MESH_H
#define GOPURA_PIPELINE_OCTREE_LOD_MESH_H

#include "pipeline/octree/lod_order.h"

/* What the meshes are made of, and room for one of them. All owned. */
struct lod_model {
	struct lod_tree tree;
	struct lod_order order;
	uint32_t vertex_count;
	struct lod_vertex *vertices; /* of the finest surface, then of each coarser level */
	uint32_t *numbers;           /* of each vertex in the mesh; valid if drawn has the round */
	uint32_t *drawn;             /* of each vertex: the round in which it was drawn last */
	uint32_t round;
};

struct lod_mesh {
	uint32_t vertex_count, triangle_count;
	uint32_t vertex_room, triangle_room;
	struct lod_vertex *vertices; /* owned */
	uint32_t (*triangles)[3];    /* owned; counter-clockwise seen from outside */
	uint32_t opened;             /* how many nodes of the LOD array */
	uint32_t
		stars; /* polygons cut from a point in their middle, to come nearer to the budget */
};

/* Prepares a model. leaves are sorted; vertices are taken (free), even on failure. Errors as
 * lod_tree_build. On failure *out is zeroed. */
must_check int lod_model_create(struct lod_model *out, struct lod_leaf *leaves, uint32_t leaf_count,
				struct lod_vertex *vertices, uint32_t vertex_count);
void lod_model_finish(struct lod_model *model); /* NULL and zeroed are fine */

/* Makes a mesh of at most `budget` triangles. *out must be zeroed or of an earlier call, whose
 * arrays are used again; the caller finishes it. One thread for each model. -ENOMEM. */
must_check int lod_mesh_make(struct lod_mesh *out, struct lod_model *model, uint32_t budget);
void lod_mesh_finish(struct lod_mesh *mesh); /* NULL and zeroed are fine */

#endif
