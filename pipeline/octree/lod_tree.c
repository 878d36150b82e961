/* Builds the octree from its leaves, level by level from below. */
#include "pipeline/octree/lod_tree.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* ---- Morton codes */

static uint64_t spread_bits(uint64_t x)
{
	x &= 0x1fffff;
	x = (x | x << 32) & 0x1f00000000ffff;
	x = (x | x << 16) & 0x1f0000ff0000ff;
	x = (x | x << 8) & 0x100f00f00f00f00f;
	x = (x | x << 4) & 0x10c30c30c30c30c3;
	return (x | x << 2) & 0x1249249249249249;
}

static uint32_t gather_bits(uint64_t x)
{
	x &= 0x1249249249249249;
	x = (x | x >> 2) & 0x10c30c30c30c30c3;
	x = (x | x >> 4) & 0x100f00f00f00f00f;
	x = (x | x >> 8) & 0x1f0000ff0000ff;
	x = (x | x >> 16) & 0x1f00000000ffff;
	return (uint32_t)((x | x >> 32) & 0x1fffff);
}

static uint64_t code_of(const uint32_t cube[3])
{
	return spread_bits(cube[0]) | spread_bits(cube[1]) << 1 | spread_bits(cube[2]) << 2;
}

uint32_t lod_neighbour(const struct lod_tree *tree, uint32_t level, uint32_t node,
		       const int shift[3])
{
	const uint32_t side = 1u << level;
	uint32_t low = tree->level_first[level], high = tree->level_first[level + 1];
	uint32_t cube[3];
	uint64_t code;

	for (int k = 0; k < 3; k++) {
		cube[k] = gather_bits(tree->codes[node] >> k) + (uint32_t)shift[k];
		if (cube[k] >= side)
			return LOD_NONE;
	}
	code = code_of(cube);
	while (low < high) {
		const uint32_t middle = low + (high - low) / 2;

		if (tree->codes[middle] < code)
			low = middle + 1;
		else
			high = middle;
	}
	return low < tree->level_first[level + 1] && tree->codes[low] == code ? low : LOD_NONE;
}

/* ---- parents */

/* A corner of the parent has the sign of the nearest corner of a child: of the child there, else of
 * a neighbour along an edge, across a face, or of the centre (the paper's four rules). A child that
 * is missing has equal signs everywhere. */
static bool corner_inside(const struct lod_tree *tree, const struct lod_node *parent, int corner)
{
	static const uint8_t nearest_first[8] = { 0, 1, 2, 4, 3, 5, 6, 7 };

	for (int i = 0; i < 8; i++) {
		const struct lod_node *child = lod_child(tree, parent, corner ^ nearest_first[i]);

		if (child)
			return child->inside >> corner & 1;
	}
	return false;
}

/* The half of the edge whose ends differ is crossed. Returns false if none is. */
static bool edge_vertex(const struct lod_tree *tree, struct lod_node *parent, int edge)
{
	const int low = cube_edge_corner(edge), high = low | 1 << edge / 4;
	const struct lod_node *halves[2] = { lod_child(tree, parent, low),
					     lod_child(tree, parent, high) };

	parent->vertices[edge] = LOD_NONE;
	if ((parent->inside >> low & 1) == (parent->inside >> high & 1))
		return true;
	for (int i = 0; i < 2; i++)
		if (halves[i] && halves[i]->vertices[edge] != LOD_NONE)
			parent->vertices[edge] = halves[i]->vertices[edge];
	return parent->vertices[edge] != LOD_NONE;
}

static bool make_parent(const struct lod_tree *tree, struct lod_node *parent)
{
	for (int c = 0; c < 8; c++)
		parent->inside |= (uint8_t)(corner_inside(tree, parent, c) << c);
	for (int e = 0; e < CUBE_EDGES; e++)
		if (!edge_vertex(tree, parent, e))
			return false;
	return true;
}

/* ---- the whole */

static void clear_node(struct lod_node *node)
{
	*node = (struct lod_node){ .number = LOD_NONE };
	memset(node->face_split, 0xff, sizeof(node->face_split));
	memset(node->edge_split, 0xff, sizeof(node->edge_split));
}

static int compare_leaves(const void *a, const void *b)
{
	const uint64_t x = code_of(((const struct lod_leaf *)a)->cube);
	const uint64_t y = code_of(((const struct lod_leaf *)b)->cube);

	return (x > y) - (x < y);
}

/* Counts the nodes of each level; leaves are sorted. */
static int lay_out(struct lod_tree *tree, const struct lod_leaf *leaves, uint32_t count)
{
	uint32_t largest = 0, levels = 1;
	uint64_t all = 0;

	for (uint32_t i = 0; i < count; i++)
		for (int k = 0; k < 3; k++)
			largest |= leaves[i].cube[k];
	while (largest >> (levels - 1))
		levels++;
	if (levels > LOD_LEVELS_MAX)
		return -EFBIG;
	tree->level_count = levels;
	for (uint32_t level = 0; level < levels; level++) {
		const uint32_t up = 3 * (levels - 1 - level);
		uint64_t nodes = 1;

		for (uint32_t i = 1; i < count; i++)
			nodes += code_of(leaves[i].cube) >> up != code_of(leaves[i - 1].cube) >> up;
		tree->level_first[level] = (uint32_t)all;
		all += nodes;
		if (all >= LOD_NONE)
			return -EFBIG;
	}
	tree->level_first[levels] = (uint32_t)all;
	return tree->level_first[levels] - tree->level_first[levels - 1] == count ? 0 : -EINVAL;
}

static int allocate(struct lod_tree *tree)
{
	const size_t all = tree->level_first[tree->level_count];

	tree->nodes = malloc(all * sizeof(*tree->nodes));
	tree->codes = malloc(all * sizeof(*tree->codes));
	tree->parents = malloc(all * sizeof(*tree->parents));
	return tree->nodes && tree->codes && tree->parents ? 0 : -ENOMEM;
}

static void fill_leaves(struct lod_tree *tree, const struct lod_leaf *leaves, uint32_t count)
{
	const uint32_t first = tree->level_first[tree->level_count - 1];

	for (uint32_t i = 0; i < count; i++) {
		struct lod_node *node = &tree->nodes[first + i];

		clear_node(node);
		node->inside = leaves[i].inside;
		memcpy(node->vertices, leaves[i].vertices, sizeof(node->vertices));
		tree->codes[first + i] = code_of(leaves[i].cube);
	}
}

static int fill_level(struct lod_tree *tree, uint32_t level)
{
	const uint32_t after = tree->level_first[level + 2];
	uint32_t child = tree->level_first[level + 1], node = tree->level_first[level];

	for (; child < after; node++) {
		struct lod_node *parent = &tree->nodes[node];

		clear_node(parent);
		parent->first_child = child;
		tree->codes[node] = tree->codes[child] >> 3;
		for (; child < after && tree->codes[child] >> 3 == tree->codes[node]; child++) {
			parent->child_mask |= (uint8_t)(1 << (tree->codes[child] & 7));
			tree->parents[child] = node;
		}
		if (!make_parent(tree, parent))
			return -EINVAL;
	}
	return 0;
}

int lod_tree_build(struct lod_tree *out, struct lod_leaf *leaves, uint32_t count)
{
	int rc = count > 0 ? 0 : -EINVAL;

	*out = (struct lod_tree){ 0 };
	if (rc == 0) {
		qsort(leaves, count, sizeof(*leaves), compare_leaves);
		rc = lay_out(out, leaves, count);
	}
	if (rc == 0)
		rc = allocate(out);
	if (rc == 0) {
		fill_leaves(out, leaves, count);
		out->parents[0] = LOD_NONE;
	}
	for (uint32_t level = out->level_count; rc == 0 && level-- > 1;)
		rc = fill_level(out, level - 1);
	if (rc < 0)
		lod_tree_finish(out);
	return rc;
}

void lod_tree_finish(struct lod_tree *tree)
{
	if (!tree)
		return;
	free(tree->nodes);
	free(tree->codes);
	free(tree->parents);
	*tree = (struct lod_tree){ 0 };
}
