/* Memory for the coefficients of a picture, and the order of its blocks in the file. */
#include "pipeline/texmesh/coefficients.h"

#include <errno.h>
#include <string.h>

static uint32_t parts(uint32_t whole, uint32_t part)
{
	return (whole + part - 1) / part;
}

static int plane_init(struct coefficient_plane *plane, const struct coefficients *coefficients,
		      bool is_colour)
{
	plane->unit_blocks = is_colour ? 1 : 2;
	plane->table = is_colour;
	plane->columns = parts(coefficients->width_px, FRAGMENT_JPEG_UNIT_PX / plane->unit_blocks);
	plane->rows = parts(coefficients->height_px, FRAGMENT_JPEG_UNIT_PX / plane->unit_blocks);
	plane->blocks = calloc((size_t)plane->columns * plane->rows,
			       COEFFICIENTS_OF_BLOCK * sizeof(*plane->blocks));
	return plane->blocks ? 0 : -ENOMEM;
}

int coefficients_init(struct coefficients *coefficients, uint32_t width_px, uint32_t height_px,
		      uint32_t fragment_units, const bool *used)
{
	size_t count;
	int rc = 0;

	memset(coefficients, 0, sizeof(*coefficients));
	coefficients->width_px = width_px;
	coefficients->height_px = height_px;
	coefficients->unit_columns = parts(width_px, FRAGMENT_JPEG_UNIT_PX);
	coefficients->unit_rows = parts(height_px, FRAGMENT_JPEG_UNIT_PX);
	coefficients->fragment_units = fragment_units;
	coefficients->columns = parts(coefficients->unit_columns, fragment_units);
	coefficients->rows = parts(coefficients->unit_rows, fragment_units);
	count = (size_t)coefficients->columns * coefficients->rows;
	coefficients->used = malloc(count * sizeof(bool));
	if (!coefficients->used)
		return -ENOMEM;
	for (size_t i = 0; i < count; i++)
		coefficients->used[i] = !used || used[i];
	for (int i = 0; i < COEFFICIENT_PLANES && rc == 0; i++)
		rc = plane_init(&coefficients->planes[i], coefficients, i > 0);
	return rc;
}

void coefficients_finish(struct coefficients *coefficients)
{
	for (int i = 0; i < COEFFICIENT_PLANES; i++)
		free(coefficients->planes[i].blocks);
	free(coefficients->used);
	memset(coefficients, 0, sizeof(*coefficients));
}

bool unit_order_next(struct unit_order *order, const struct coefficients *coefficients,
		     const struct coefficient_plane *plane)
{
	while (order->unit_column < coefficients->unit_columns) {
		uint32_t side = plane->unit_blocks, index = order->index++;

		if (index == side * side) {
			order->index = 0;
			order->unit_column++;
			continue;
		}
		order->column = order->unit_column * side + index % side;
		order->row = order->unit_row * side + index / side;
		if (order->column < plane->columns && order->row < plane->rows)
			return true;
	}
	return false;
}
