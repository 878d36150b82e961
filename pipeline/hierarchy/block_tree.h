/* Divides a model of any size into blocks that fit in memory, and orders the work on them as a tree
 * (docs/hierarchy.md). Leaves are boxes of cells with about equally many triangles each. An inner
 * node joins what its children have left over, so it has about as much to do as a leaf. The tree
 * depends on the model alone: it decides bytes. */
#ifndef GOPURA_PIPELINE_HIERARCHY_BLOCK_TREE_H
#define GOPURA_PIPELINE_HIERARCHY_BLOCK_TREE_H

#include <stdint.h>

#include "base/compiler.h"

enum {
	BLOCK_CELL_BITS = 7, /* cells along the longest side of the lattice: 2 to this power */
	BLOCK_CELLS_SIDE = 1 << BLOCK_CELL_BITS,
	BLOCK_CELLS = BLOCK_CELLS_SIDE * BLOCK_CELLS_SIDE * BLOCK_CELLS_SIDE,
	BLOCK_FANOUT = 4, /* most children of a node, and what a node reduces its triangles to */
};

#define BLOCK_NONE UINT32_MAX

/* Nodes 0 to leaf_count - 1 are the leaves. Parents come after their children; the last is the
 * root, which is the leaf where there is only one. A node covers the leaves first_leaf to last_leaf
 * and nobody else does on its level. */
struct block_node {
	uint32_t first_leaf, last_leaf;
	uint32_t parent;         /* BLOCK_NONE: the root */
	uint64_t triangle_count; /* of the scan, in its leaves */
};

struct block_tree {
	uint32_t leaf_count, node_count;
	struct block_node *nodes; /* owned */
	uint32_t *leaf_of_cell;   /* owned; BLOCK_CELLS entries */
};

/* Returns the cell at a place on the lattice. */
uint32_t block_cell(const uint16_t position[3]);

/* Returns the cell that a triangle counts for: the one that holds most of its corners, or of three
 * different ones that with the lowest number. So triangles with the same corners count for the same
 * cell. */
uint32_t block_cell_of_triangle(const uint16_t corners[3][3]);

/* Makes the tree for a number of triangles in each cell (BLOCK_CELLS entries, not all zero). A leaf
 * has at most that many triangles, unless one cell has more. *out is owned by the caller; zeroed on
 * failure. Returns -ENOMEM, or -EINVAL if there are no triangles. */
must_check int block_tree_create(struct block_tree *out, const uint32_t *triangles_in_cell,
				 uint32_t block_triangles);
void block_tree_finish(struct block_tree *tree); /* NULL is fine */

#endif
