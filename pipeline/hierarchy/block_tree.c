/* Halves boxes of cells until each holds few enough triangles, and builds the tree of work over
 * them. */
#include "pipeline/hierarchy/block_tree.h"

#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>

struct box {
	uint32_t low[3], high[3]; /* cells; high is past the last */
};

struct planter {
	const uint32_t *counts;
	uint32_t block_triangles;
	struct block_tree *out;
	/* Inner nodes while the leaves are not all known. Their children name them by number; they
	 * are numbered after the leaves at the end. */
	struct block_node *inner;
	uint32_t inner_count, inner_room, leaf_room;
};

uint32_t block_cell(const uint16_t position[3])
{
	uint32_t cell = 0;

	for (int k = 2; k >= 0; k--)
		cell = cell << BLOCK_CELL_BITS | position[k] >> (16 - BLOCK_CELL_BITS);
	return cell;
}

uint32_t block_cell_of_triangle(const uint16_t corners[3][3])
{
	uint32_t a = block_cell(corners[0]), b = block_cell(corners[1]);
	uint32_t c = block_cell(corners[2]), least = a < b ? a : b;

	if (a == b || a == c)
		return a;
	return b == c ? b : c < least ? c : least;
}

/* ---- boxes */

static uint32_t cell_at(uint32_t x, uint32_t y, uint32_t z)
{
	return (z << BLOCK_CELL_BITS | y) << BLOCK_CELL_BITS | x;
}

/* Adds up the triangles of each slice of the box along each axis. */
static uint64_t count_slices(uint64_t slices[3][BLOCK_CELLS_SIDE], const struct planter *planter,
			     const struct box *box)
{
	uint64_t total = 0;

	for (int k = 0; k < 3; k++)
		for (uint32_t i = 0; i < BLOCK_CELLS_SIDE; i++)
			slices[k][i] = 0;
	for (uint32_t z = box->low[2]; z < box->high[2]; z++)
		for (uint32_t y = box->low[1]; y < box->high[1]; y++)
			for (uint32_t x = box->low[0]; x < box->high[0]; x++) {
				uint32_t count = planter->counts[cell_at(x, y, z)];

				slices[0][x] += count;
				slices[1][y] += count;
				slices[2][z] += count;
				total += count;
			}
	return total;
}

/* Cuts off empty slices at both ends. */
static void tighten(struct box *box, uint64_t slices[3][BLOCK_CELLS_SIDE])
{
	for (int k = 0; k < 3; k++) {
		while (box->low[k] + 1 < box->high[k] && slices[k][box->low[k]] == 0)
			box->low[k]++;
		while (box->low[k] + 1 < box->high[k] && slices[k][box->high[k] - 1] == 0)
			box->high[k]--;
	}
}

/* Cuts the longest axis where the halves differ least. Returns false for a single cell. */
static bool cut(struct box halves[2], const struct box *box, uint64_t slices[3][BLOCK_CELLS_SIDE],
		uint64_t total)
{
	uint64_t below = 0, best_difference = UINT64_MAX;
	uint32_t best = 0;
	int axis = 0;

	for (int k = 1; k < 3; k++)
		if (box->high[k] - box->low[k] > box->high[axis] - box->low[axis])
			axis = k;
	for (uint32_t at = box->low[axis] + 1; at < box->high[axis]; at++) {
		uint64_t difference;

		below += slices[axis][at - 1];
		difference = 2 * below > total ? 2 * below - total : total - 2 * below;
		if (difference < best_difference) {
			best_difference = difference;
			best = at;
		}
	}
	if (best == 0)
		return false;
	halves[0] = halves[1] = *box;
	halves[0].high[axis] = halves[1].low[axis] = best;
	return true;
}

/* ---- nodes */

static int grow(struct block_node **nodes, uint32_t *room, uint32_t count)
{
	struct block_node *grown;

	if (count < *room)
		return 0;
	grown = realloc(*nodes, (2 * *room + 16) * sizeof(*grown));
	if (!grown)
		return -ENOMEM;
	*nodes = grown;
	*room = 2 * *room + 16;
	return 0;
}

static int add_leaf(struct planter *planter, const struct box *box, uint64_t total, uint32_t parent)
{
	struct block_tree *out = planter->out;
	int rc = grow(&out->nodes, &planter->leaf_room, out->leaf_count);

	if (rc < 0)
		return rc;
	for (uint32_t z = box->low[2]; z < box->high[2]; z++)
		for (uint32_t y = box->low[1]; y < box->high[1]; y++)
			for (uint32_t x = box->low[0]; x < box->high[0]; x++)
				out->leaf_of_cell[cell_at(x, y, z)] = out->leaf_count;
	out->nodes[out->leaf_count] = (struct block_node){
		.first_leaf = out->leaf_count,
		.last_leaf = out->leaf_count,
		.parent = parent,
		.triangle_count = total,
	};
	out->leaf_count++;
	return 0;
}

/* How many times a node must reduce its triangles by BLOCK_FANOUT until they fit in a block. */
static uint32_t rank_of(const struct planter *planter, uint64_t triangle_count)
{
	uint32_t rank = 0;

	for (uint64_t most = planter->block_triangles; triangle_count > most; most *= BLOCK_FANOUT)
		rank++;
	return rank;
}

/* Not every half is a node: only those of which about BLOCK_FANOUT make up their parent. */
static int plant(struct planter *planter, struct box box, uint32_t parent, uint32_t parent_rank)
{
	uint64_t slices[3][BLOCK_CELLS_SIDE];
	uint64_t total = count_slices(slices, planter, &box);
	uint32_t rank = rank_of(planter, total), inner = parent, first = planter->out->leaf_count;
	struct box halves[2];
	int rc = 0;

	if (rank > 0)
		tighten(&box, slices);
	if (rank == 0 || !cut(halves, &box, slices, total))
		return add_leaf(planter, &box, total, parent);
	if (rank < parent_rank) {
		rc = grow(&planter->inner, &planter->inner_room, planter->inner_count);
		inner = planter->inner_count++;
		if (rc == 0)
			planter->inner[inner] =
				(struct block_node){ .parent = parent, .triangle_count = total };
	}
	for (int half = 0; rc == 0 && half < 2; half++)
		rc = plant(planter, halves[half], inner, rank);
	if (rc == 0 && inner != parent) {
		planter->inner[inner].first_leaf = first;
		planter->inner[inner].last_leaf = planter->out->leaf_count - 1;
	}
	return rc;
}

/* Inner nodes were numbered with parents first. Puts them after the leaves, parents last. */
static int join(struct planter *planter)
{
	struct block_tree *out = planter->out;
	uint32_t last = out->leaf_count + planter->inner_count - 1;
	struct block_node *grown = realloc(out->nodes, (last + 1) * sizeof(*grown));

	if (!grown)
		return -ENOMEM;
	out->nodes = grown;
	out->node_count = last + 1;
	for (uint32_t i = 0; i < planter->inner_count; i++)
		out->nodes[last - i] = planter->inner[i];
	for (uint32_t n = 0; n < out->node_count; n++)
		if (out->nodes[n].parent != BLOCK_NONE)
			out->nodes[n].parent = last - out->nodes[n].parent;
	return 0;
}

int block_tree_create(struct block_tree *out, const uint32_t *triangles_in_cell,
		      uint32_t block_triangles)
{
	struct planter planter = {
		.counts = triangles_in_cell,
		.block_triangles = block_triangles,
		.out = out,
	};
	const struct box all = {
		.high = { BLOCK_CELLS_SIDE, BLOCK_CELLS_SIDE, BLOCK_CELLS_SIDE },
	};
	int rc;

	/* A leaf may cover more than the cells that were counted for it: its box was cut tight.
	 * What lies outside all boxes has no triangles, but it may have corners of some. */
	*out = (struct block_tree){ .leaf_of_cell =
					    calloc(BLOCK_CELLS, sizeof(*out->leaf_of_cell)) };
	rc = out->leaf_of_cell ? plant(&planter, all, BLOCK_NONE, UINT32_MAX) : -ENOMEM;
	if (rc == 0)
		rc = join(&planter);
	free(planter.inner);
	if (rc < 0)
		block_tree_finish(out);
	else if (out->nodes[out->node_count - 1].triangle_count == 0) {
		block_tree_finish(out);
		rc = -EINVAL;
	}
	return rc;
}

void block_tree_finish(struct block_tree *tree)
{
	if (!tree)
		return;
	free(tree->nodes);
	free(tree->leaf_of_cell);
	*tree = (struct block_tree){ 0 };
}
