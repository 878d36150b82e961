/* Counts the points in the cells of a grid over the cloud's box. A surface through a cell is about
 * as large as a side of it, so the count says how close the points are. */
#include "pipeline/octree/range_cloud.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "base/spill.h"

/* Cells along the longest side: so many that one has about POINTS_A_CELL, if CELLS_OF_SIDES of the
 * cells of a side of the box have any. */
enum { CELLS_MAX = 128, POINTS_A_CELL = 16, CELLS_OF_SIDES = 3 };

/* Of points at random, so many distances around nearly any place have one. */
static const double unevenness = 2;

struct cloud_grid {
	double low[3], side; /* of a cell */
	uint32_t along;      /* cells along each axis */
};

static void measure(struct cloud_grid *grid, const struct range_point *points, uint32_t count)
{
	double high[3] = { -INFINITY, -INFINITY, -INFINITY }, longest = 0;
	const double wanted = sqrt((double)count / (POINTS_A_CELL * CELLS_OF_SIDES));

	for (int k = 0; k < 3; k++)
		grid->low[k] = INFINITY;
	for (uint32_t i = 0; i < count; i++) {
		for (int k = 0; k < 3; k++) {
			grid->low[k] = fmin(grid->low[k], points[i].at[k]);
			high[k] = fmax(high[k], points[i].at[k]);
		}
		spill_pass(i);
	}
	for (int k = 0; k < 3; k++)
		longest = fmax(longest, high[k] - grid->low[k]);
	grid->along = (uint32_t)fmax(1, fmin(CELLS_MAX, wanted));
	grid->side = longest / grid->along;
}

static size_t cell_of(const struct cloud_grid *grid, const double at[3])
{
	size_t cell = 0;

	for (int k = 0; k < 3; k++)
		cell = cell * grid->along +
		       (size_t)fmin(grid->along - 1, (at[k] - grid->low[k]) / grid->side);
	return cell;
}

static int compare_counts(const void *a, const void *b)
{
	const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;

	return (x > y) - (x < y);
}

/* Returns how many points the cell of the median point has. Few points far from the others, which
 * have a cell each, do not matter. */
static uint32_t median_count(uint32_t *counts, size_t cells, uint32_t points)
{
	uint64_t before = 0;
	size_t i = 0;

	qsort(counts, cells, sizeof(*counts), compare_counts);
	while (i + 1 < cells && (before += counts[i]) < (points + 1ull) / 2)
		i++;
	return counts[i];
}

int range_cloud_spacing(double *out, struct range_point *points, uint32_t count)
{
	struct cloud_grid grid;
	uint32_t *counts;
	size_t cells;

	*out = 0;
	measure(&grid, points, count);
	if (!(grid.side > 0))
		return 0;
	cells = (size_t)grid.along * grid.along * grid.along;
	counts = calloc(cells, sizeof(*counts));
	if (!counts)
		return -ENOMEM;
	for (uint32_t i = 0; i < count; i++) {
		counts[cell_of(&grid, points[i].at)]++;
		spill_pass(i);
	}
	*out = grid.side / sqrt(median_count(counts, cells, count));
	free(counts);
	for (uint32_t i = 0; i < count; i++) {
		points[i].spacing = (float)(unevenness * *out);
		spill_pass(i);
	}
	return 0;
}
