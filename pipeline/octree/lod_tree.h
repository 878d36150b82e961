/* The marching-cube octree (paper P1, sections 5.1 and 5.2): each node is a marching cube; a parent
 * takes its signs and crossing points from its children. The surface has a sign at every corner of
 * the leaf cubes, as cube_surface_draw gives it with is_closed.
 *
 * A parent's edge crosses the surface where one of its two halves does, so at first all levels have
 * the vertices of the finest one; lod_place gives each its own. */
#ifndef GOPURA_PIPELINE_OCTREE_LOD_TREE_H
#define GOPURA_PIPELINE_OCTREE_LOD_TREE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/compiler.h"
#include "pipeline/octree/cube_table.h"

enum { LOD_LEVELS_MAX = 21, LOD_CUBE_FACES = 6 };
#define LOD_NONE UINT32_MAX
/* A leaf cube is that many steps wide in struct lod_vertex. */
enum { LOD_CUBE_STEPS = 256 };

struct lod_vertex {
	int32_t place[3]; /* in steps */
	uint8_t colour[4];
};

struct lod_leaf {
	uint32_t cube[3]; /* below 1 << LOD_LEVELS_MAX - 1 */
	uint8_t inside;   /* as cube_case_of */
	uint32_t vertices[CUBE_EDGES];
};

/* Face 2 a + side is orthogonal to axis a; corners and edges are numbered as in cube_table.h. */
struct lod_node {
	uint8_t inside;       /* bit c: corner c lies inside */
	uint8_t child_mask;   /* bit c: there is a child at corner c; 0: a leaf */
	uint32_t first_child; /* the children lie one after the other, by ascending corner */
	uint32_t vertices[CUBE_EDGES]; /* on its edges; LOD_NONE: not crossed */
	/* When it is opened (replaced by its children): its place in the LOD array. LOD_NONE: leaf.
	 */
	uint32_t number;
	/* When the first other node of its size at that face or edge is opened; LOD_NONE: never. */
	uint32_t face_split[LOD_CUBE_FACES], edge_split[CUBE_EDGES];
};

struct lod_tree {
	uint32_t level_count;                     /* level 0 is the root */
	uint32_t level_first[LOD_LEVELS_MAX + 2]; /* first node of each level, and the node count */
	struct lod_node *nodes;                   /* owned; level by level, by Morton code */
	uint64_t *codes;                          /* of each node in its level; owned */
	uint32_t *parents;                        /* owned; of the root: LOD_NONE */
};

/* Builds the tree. The leaves are sorted in place. *out is owned by the caller; it is zeroed on
 * failure. No node is numbered. -EINVAL: no leaves, two at one place, or signs that do not belong
 * together. -EFBIG: beyond 32-bit counts or LOD_LEVELS_MAX. -ENOMEM. */
must_check int lod_tree_build(struct lod_tree *out, struct lod_leaf *leaves, uint32_t count);
void lod_tree_finish(struct lod_tree *tree); /* NULL and zeroed are fine */

/* Returns the child at a corner, or NULL. */
static inline const struct lod_node *lod_child(const struct lod_tree *tree,
					       const struct lod_node *node, int corner)
{
	const unsigned before = node->child_mask & ((1u << corner) - 1);

	if (!(node->child_mask >> corner & 1))
		return NULL;
	return &tree->nodes[node->first_child + (uint32_t)__builtin_popcount(before)];
}

/* Returns the node of the same level that is shifted by a step of -1, 0 or 1 along each axis, or
 * LOD_NONE. */
uint32_t lod_neighbour(const struct lod_tree *tree, uint32_t level, uint32_t node,
		       const int shift[3]);

#endif
