/* Gives the nodes above the leaves vertices of their own, at better places than the crossings of
 * their edges: where the sum of the squared distances to the planes of the finest surface in the
 * nodes around the edge is least (Garland and Heckbert 1997), as in dual contouring, but with the
 * polygons of marching cubes. So a coarse surface bulges and has edges as the fine one does.
 *
 * An edge of a node is drawn whole by all nodes around it, or in halves by all of them, so each
 * level may have vertices of its own and the surface stays closed. */
#ifndef GOPURA_PIPELINE_OCTREE_LOD_PLACE_H
#define GOPURA_PIPELINE_OCTREE_LOD_PLACE_H

#include "pipeline/octree/lod_tree.h"

/* Vertices are added to the array, which grows (its address may change, even on failure). *gains is
 * owned by the caller (free) and NULL on failure: of each node that has children, how much the
 * surface gains if it is opened: the sum over the area in it of the squared distance from its own
 * surface, in leaf cubes. -ENOMEM; -EFBIG: beyond 32-bit counts. */
must_check int lod_place(float **gains, struct lod_tree *tree, struct lod_vertex **vertices,
			 uint32_t *vertex_count);

#endif
