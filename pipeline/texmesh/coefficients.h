/* The quantized DCT coefficients of a 4:2:0 JPEG picture that is cut into fragments, and their
 * rounding to coarser quantization steps. Private to this room. */
#ifndef GOPURA_PIPELINE_TEXMESH_COEFFICIENTS_H
#define GOPURA_PIPELINE_TEXMESH_COEFFICIENTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include "pipeline/texmesh/fragment_jpeg.h"

enum {
	COEFFICIENT_PLANES = 3,     /* brightness, two of colour */
	COEFFICIENTS_OF_BLOCK = 64, /* 8 x 8 pixels of a plane */
	COEFFICIENT_MOST = 1023,    /* what a JPEG of 8 bits can hold, either sign */
};

struct coefficient_plane {
	int16_t *blocks;        /* owned; row by row; 64 numbers each, in natural order */
	uint32_t columns, rows; /* blocks, as far as the picture goes */
	uint32_t unit_blocks;   /* a side of a unit: 2 or 1 */
	uint32_t table;         /* of quantization steps: 0, colour 1 */
};

struct coefficients {
	uint32_t width_px, height_px;
	uint32_t unit_columns, unit_rows;
	uint32_t fragment_units; /* a side of a fragment */
	uint8_t best;            /* quality, whose steps they are in */
	uint32_t columns, rows;  /* fragments */
	bool *used;              /* owned; for each fragment */
	struct coefficient_plane planes[COEFFICIENT_PLANES];
	/* How many steps of the best quality make about one of each quality; in natural order. */
	uint8_t factors[FRAGMENT_JPEG_QUALITY_MOST + 1][2][COEFFICIENTS_OF_BLOCK];
};

/* Takes sizes that are not zero. used is copied; NULL: all. All blocks are zero. -ENOMEM; finish it
 * then, too. */
must_check int coefficients_init(struct coefficients *coefficients, uint32_t width_px,
				 uint32_t height_px, uint32_t fragment_units, const bool *used);
void coefficients_finish(struct coefficients *coefficients); /* zeroed is fine */

static inline int16_t *coefficients_of(const struct coefficient_plane *plane, uint32_t column,
				       uint32_t row)
{
	return plane->blocks + ((size_t)row * plane->columns + column) * COEFFICIENTS_OF_BLOCK;
}

static inline uint32_t coefficients_fragment(const struct coefficients *coefficients,
					     uint32_t unit_column, uint32_t unit_row)
{
	return unit_row / coefficients->fragment_units * coefficients->columns +
	       unit_column / coefficients->fragment_units;
}

/* Rounds to the nearest multiple of factor. Halves go towards zero: at a factor of 2 every other
 * number is a half, and away from zero it would take more bytes than before. */
static inline int coefficient_round(int coefficient, int factor)
{
	int rounded = (abs(coefficient) + (factor - 1) / 2) / factor * factor;

	return coefficient < 0 ? -rounded : rounded;
}

/* The blocks of a plane in the order in which the scan of means has them: unit by unit. */
struct unit_order {
	uint32_t unit_column, unit_row, index; /* block in the unit */
	uint32_t column, row;                  /* of the block in the plane */
};

/* Moves on to the next block of a row of units, from { .unit_row = row } on: sets column and row.
 * Returns false at the end of the row. Skips what lies outside the picture. */
bool unit_order_next(struct unit_order *order, const struct coefficients *coefficients,
		     const struct coefficient_plane *plane);

#endif
