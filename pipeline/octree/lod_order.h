/* The LOD array and the accumulation table (paper P1, sections 5.2 and 6.1): in which order nodes
 * are opened, and how many triangles the surface then has. The node that gains most by it (see
 * lod_place) is opened first. Before it are opened the larger neighbours that it touches, so that
 * two nodes that touch never differ by more than one level. (The paper takes the change of the area
 * as the gain, and lets a node wait for its neighbours; then a flat or smoothed neighbour holds
 * back whole limbs of a statue: docs/octree.md.) */
#ifndef GOPURA_PIPELINE_OCTREE_LOD_ORDER_H
#define GOPURA_PIPELINE_OCTREE_LOD_ORDER_H

#include "pipeline/octree/lod_tree.h"

struct lod_order {
	uint32_t count;      /* nodes that can be opened */
	uint32_t *nodes;     /* the LOD array; owned */
	uint32_t *triangles; /* of the surface once i nodes are open, 0 .. count; owned */
	uint32_t *most;      /* the largest of triangles up to there; owned */
};

/* Numbers the nodes of the tree. gains: of each node that has children, how urgent it is. *out is
 * owned by the caller; it is zeroed on failure. -ENOMEM. */
must_check int lod_order_make(struct lod_order *out, struct lod_tree *tree, const float *gains);
void lod_order_finish(struct lod_order *order); /* NULL and zeroed are fine */

/* Returns how many nodes to open for at most that many triangles. */
uint32_t lod_order_find(const struct lod_order *order, uint32_t triangles);

#endif
