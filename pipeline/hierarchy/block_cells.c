/* Builds the graph of the cells that are not empty, and divides it. */
#include "pipeline/hierarchy/block_cells.h"

#include <errno.h>
#include <stdlib.h>

#include "pipeline/hierarchy/graph.h"

#define NO_NODE  UINT32_MAX
#define NO_BLOCK UINT32_MAX

enum { WEIGHT_MAX = 1 << 20 };

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

static const uint32_t stride[3] = { 1, BLOCK_CELLS_SIDE, BLOCK_CELLS_SIDE *BLOCK_CELLS_SIDE };

static uint32_t place_in(uint32_t cell, int axis)
{
	return cell / stride[axis] % BLOCK_CELLS_SIDE;
}

void block_counts_add(struct block_counts *counts, const uint16_t corners[3][3])
{
	uint32_t cells[3];

	for (int c = 0; c < 3; c++)
		cells[c] = block_cell(corners[c]);
	__atomic_fetch_add(&counts->triangles[block_cell_of_triangle(corners)], 1,
			   __ATOMIC_RELAXED);
	for (int c = 0; c < 3; c++) {
		uint32_t a = cells[c], b = cells[(c + 1) % 3], low = a < b ? a : b;

		for (int k = 0; a != b && k < 3; k++)
			if (a + b - 2 * low == stride[k])
				__atomic_fetch_add(&counts->crossings[k][low], 1, __ATOMIC_RELAXED);
	}
}

/* ---- the graph */

struct divider {
	const struct block_counts *counts;
	struct block_cells *out;
	uint32_t *node_of; /* for each cell, or NO_NODE */
	uint32_t *cell_of; /* for each node */
	struct graph graph;
};

static int add_edges(struct divider *divider)
{
	int rc = 0;

	for (uint32_t i = 0; rc == 0 && i < divider->graph.node_count; i++)
		for (int k = 0; rc == 0 && k < 3; k++) {
			uint32_t cell = divider->cell_of[i];
			uint32_t weight = divider->counts->crossings[k][cell], next;

			if (weight == 0 || place_in(cell, k) == BLOCK_CELLS_SIDE - 1)
				continue;
			next = divider->node_of[cell + stride[k]];
			if (next != NO_NODE)
				rc = graph_add(&divider->graph, i, next,
					       weight < WEIGHT_MAX ? (int32_t)weight : WEIGHT_MAX);
		}
	return rc;
}

static int make_graph(struct divider *divider)
{
	uint32_t count = 0;
	int rc;

	divider->node_of = malloc(BLOCK_CELLS * sizeof(*divider->node_of));
	divider->cell_of = malloc(BLOCK_CELLS * sizeof(*divider->cell_of));
	if (!divider->node_of || !divider->cell_of)
		return -ENOMEM;
	for (uint32_t cell = 0; cell < BLOCK_CELLS; cell++) {
		divider->node_of[cell] = divider->counts->triangles[cell] > 0 ? count : NO_NODE;
		divider->cell_of[count] = cell;
		count += divider->counts->triangles[cell] > 0;
	}
	if (count == 0)
		return -EINVAL;
	rc = graph_init(&divider->graph, count);
	for (uint32_t i = 0; rc == 0 && i < count; i++)
		divider->graph.node_weights[i] =
			(int32_t)divider->counts->triangles[divider->cell_of[i]];
	return rc < 0 ? rc : add_edges(divider);
}

/* Parts that do not touch are joined to what is near. */
static int connect(struct divider *divider)
{
	uint32_t count = divider->graph.node_count;
	float(*at)[3] = malloc(count * sizeof(*at));
	int rc;

	for (uint32_t i = 0; at && i < count; i++)
		for (int k = 0; k < 3; k++)
			at[i][k] =
				(float)(place_in(divider->cell_of[i], k) << (16 - BLOCK_CELL_BITS));
	rc = at ? graph_connect(&divider->graph, at, 1) : -ENOMEM;
	free(at);
	return rc;
}

/* ---- blocks */

/* The cells around one without a block get its block. */
static void name_cells_beside(const struct block_cells *out, uint32_t cell, uint32_t block)
{
	for (int z = -1; z <= 1; z++)
		for (int y = -1; y <= 1; y++)
			for (int x = -1; x <= 1; x++) {
				const int step[3] = { x, y, z };
				int64_t beside = cell;

				for (int k = 0; k < 3; k++)
					beside += step[k] * (int64_t)stride[k];
				if (beside >= 0 && beside < BLOCK_CELLS &&
				    out->block_of_cell[beside] == NO_BLOCK)
					out->block_of_cell[beside] = block;
			}
}

static int name_blocks(struct divider *divider, const uint32_t *labels)
{
	struct block_cells *out = divider->out;
	const uint32_t *cell_of = divider->cell_of, nodes = divider->graph.node_count;

	out->block_of_cell = malloc(BLOCK_CELLS * sizeof(*out->block_of_cell));
	out->triangle_counts = calloc(out->block_count, sizeof(*out->triangle_counts));
	if (!out->block_of_cell || !out->triangle_counts)
		return -ENOMEM;
	for (uint32_t cell = 0; cell < BLOCK_CELLS; cell++)
		out->block_of_cell[cell] = NO_BLOCK;
	for (uint32_t i = 0; i < nodes; i++) {
		out->block_of_cell[cell_of[i]] = labels[i];
		out->triangle_counts[labels[i]] += divider->counts->triangles[cell_of[i]];
	}
	/* A cell without triangles may have corners of some: the first cell beside it decides. */
	for (uint32_t i = 0; i < nodes; i++)
		name_cells_beside(out, cell_of[i], labels[i]);
	for (uint32_t cell = 0; cell < BLOCK_CELLS; cell++)
		if (out->block_of_cell[cell] == NO_BLOCK)
			out->block_of_cell[cell] = 0;
	return 0;
}

static int divide(struct divider *divider, uint32_t block_triangles)
{
	struct block_cells *out = divider->out;
	uint32_t nodes = divider->graph.node_count, *labels = malloc(nodes * sizeof(*labels));
	uint64_t total = 0, blocks;
	int rc = labels ? connect(divider) : -ENOMEM;

	for (uint32_t i = 0; i < nodes; i++)
		total += (uint32_t)divider->graph.node_weights[i];
	blocks = (total + block_triangles - 1) / block_triangles;
	out->block_count = blocks < nodes ? (uint32_t)blocks : nodes;
	if (rc == 0)
		rc = graph_divide(labels, &divider->graph, out->block_count, NULL);
	if (rc == 0)
		rc = name_blocks(divider, labels);
	free(labels);
	return rc;
}

int block_cells_create(struct block_cells *out, const struct block_counts *counts,
		       uint32_t block_triangles)
{
	struct divider divider = { .counts = counts, .out = out };
	int rc;

	*out = (struct block_cells){ 0 };
	rc = make_graph(&divider);
	if (rc == 0)
		rc = divide(&divider, block_triangles);
	graph_finish(&divider.graph);
	free(divider.node_of);
	free(divider.cell_of);
	if (rc < 0)
		block_cells_finish(out);
	return rc;
}

void block_cells_finish(struct block_cells *cells)
{
	if (!cells)
		return;
	free(cells->block_of_cell);
	free(cells->triangle_counts);
	*cells = (struct block_cells){ 0 };
}
