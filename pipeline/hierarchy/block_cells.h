/* Divides a model of any size into blocks that fit in memory: sets of cells with about equally many
 * triangles each. METIS cuts where few triangles cross from cell to cell, as borders are locked
 * (paper P0 3.1). Blocks depend on the model alone, because they decide bytes. */
#ifndef GOPURA_PIPELINE_HIERARCHY_BLOCK_CELLS_H
#define GOPURA_PIPELINE_HIERARCHY_BLOCK_CELLS_H

#include <stdint.h>

#include "base/compiler.h"

enum {
	BLOCK_CELL_BITS = 7, /* cells along the longest side of the lattice: 2 to this power */
	BLOCK_CELLS_SIDE = 1 << BLOCK_CELL_BITS,
	BLOCK_CELLS = BLOCK_CELLS_SIDE * BLOCK_CELLS_SIDE * BLOCK_CELLS_SIDE,
};

/* What is counted in the scan, by any thread and process. */
struct block_counts {
	uint32_t triangles[BLOCK_CELLS];
	/* Triangles that cross from a cell to the next along an axis. */
	uint32_t crossings[3][BLOCK_CELLS];
};

struct block_cells {
	uint32_t block_count;
	uint32_t *block_of_cell;   /* owned; BLOCK_CELLS entries */
	uint64_t *triangle_counts; /* owned; for each block */
};

/* Returns the cell at a place on the lattice. */
uint32_t block_cell(const uint16_t position[3]);

/* Returns the cell that a triangle counts for: the one that holds most of its corners, or of three
 * different ones that with the lowest number. So triangles with the same corners count for the same
 * cell. */
uint32_t block_cell_of_triangle(const uint16_t corners[3][3]);

void block_counts_add(struct block_counts *counts, const uint16_t corners[3][3]);

/* Makes blocks of about that many triangles. *out is owned by the caller; zeroed on failure.
 * Returns -ENOMEM, or -EINVAL if there are no triangles. */
must_check int block_cells_create(struct block_cells *out, const struct block_counts *counts,
				  uint32_t block_triangles);
void block_cells_finish(struct block_cells *cells); /* NULL is fine */

#endif
