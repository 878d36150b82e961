/* Builds a bounding volume hierarchy (BVH): a binary tree of boxes over items such as triangles. It
 * sorts the items by splits at the median, so every node is a contiguous range of them. Queries
 * walk the array of nodes with tests of their own. */
#ifndef GOPURA_GEOMETRY_BVH_H
#define GOPURA_GEOMETRY_BVH_H

#include <stdint.h>

enum {
	BVH_LEAF_MAX = 8,  /* items in a leaf */
	BVH_STACK_MAX = 32 /* nodes that a walk from the root keeps for later */
};

struct bvh_node {
	float low[3], high[3];
	/* range of the sorted items; the children of an inner node are node + 1 and right */
	uint32_t first, count;
	uint32_t right; /* index of the right child; 0: a leaf */
};

/* What bvh_build sorts. All is the caller's. */
struct bvh_items {
	uint32_t count;
	uint32_t *order; /* the number of each item; the caller sets it to 0, 1, 2 ... */
	/* key_count numbers an item, sorted together with order. The first three tell the item's
	 * place along x, y and z, in any unit. */
	float *keys;
	int key_count;
	/* Extends a box so that it holds the item with that number. */
	void (*extend)(const void *data, uint32_t number, float low[3], float high[3]);
	/* Returns the key along which a range is split; NULL: the place along the longest axis. */
	int (*choose_key)(const struct bvh_items *items, uint32_t first, uint32_t count);
	const void *data; /* for extend */
};

/* Returns how many nodes bvh_build needs room for. */
uint32_t bvh_nodes_max(uint32_t item_count);
/* Builds the tree, parents before children, and sorts order and keys. There is at least one item.
 * Returns the number of nodes. */
uint32_t bvh_build(struct bvh_node *nodes, struct bvh_items *items);
/* Returns the difference between the largest and the smallest value of a key in a range. */
float bvh_extent(const struct bvh_items *items, uint32_t first, uint32_t count, int key);

#endif
