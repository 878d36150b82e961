/* Marks the cells of each face of each point that the places, which are widened to the distance of
 * their neighbours, appear in. */
#include "pipeline/samples/sampling_forecast.h"

#include <math.h>
#include <string.h>

#include "format/cube.h"
#include "pipeline/samples/sampler.h"

/* Places are widened to this part of their mean distance, on each side. */
static const double widening = 4;
/* A point that sees the surface in more than this share of all directions is in solid matter. */
static const double surrounded = 0.72;

enum { CELLS_MAX = 1 << (SAMPLE_LEVELS_MAX - 1) };

/* The finest level's tiles of a face, one cell each. */
struct face_cells {
	bool marked[CELLS_MAX][CELLS_MAX];
	uint32_t place_count;
};

static void mark(struct face_cells *cells, uint32_t side, double x, double y, double radius)
{
	int from[2], to[2];
	double at[2] = { x, y };

	for (int k = 0; k < 2; k++) {
		from[k] = (int)floor((at[k] - radius + 1) / 2 * side);
		to[k] = (int)floor((at[k] + radius + 1) / 2 * side);
		from[k] = from[k] < 0 ? 0 : from[k];
		to[k] = to[k] >= (int)side ? (int)side - 1 : to[k];
	}
	for (int row = from[1]; row <= to[1]; row++)
		for (int column = from[0]; column <= to[0]; column++)
			cells->marked[row][column] = true;
}

/* Returns the share of all directions in which something was seen. */
static double seen_share(const struct face_cells cells[CUBE_FACES], uint32_t side)
{
	uint32_t count = 0;

	for (int face = 0; face < CUBE_FACES; face++)
		for (uint32_t row = 0; row < side; row++)
			for (uint32_t column = 0; column < side; column++)
				count += cells[face].marked[row][column];
	return (double)count / (CUBE_FACES * side * side);
}

/* Adds the tiles of the face at all levels. */
static void count_tiles(struct sampling_forecast *out, struct face_cells *cells, uint32_t side)
{
	uint64_t before = out->tile_count;

	for (; side > 0; side /= 2)
		for (uint32_t row = 0; row < side; row++)
			for (uint32_t column = 0; column < side; column++) {
				bool marked = cells->marked[row][column];

				out->tile_count += marked;
				/* for the next coarser level; that cell has been read before */
				if (row % 2 || column % 2)
					cells->marked[row / 2][column / 2] |= marked;
				else
					cells->marked[row / 2][column / 2] = marked;
			}
	out->face_count += out->tile_count > before;
}

/* Marks where a place appears from a point. */
static void see(struct face_cells cells[CUBE_FACES], uint32_t side, const float place_m[3],
		const float point_m[3], float spacing_m)
{
	float away[3], depth, u, v;
	int face;

	for (int k = 0; k < 3; k++)
		away[k] = place_m[k] - point_m[k];
	depth = fmaxf(fabsf(away[0]), fmaxf(fabsf(away[1]), fabsf(away[2])));
	if (!(depth > 0))
		return;
	face = cube_project(away, &u, &v);
	mark(&cells[face], side, u, -v, spacing_m / depth);
	cells[face].place_count++;
}

void sampling_forecast(struct sampling_forecast *out, const struct sample_grid *grid,
		       const float (*places_m)[3], uint32_t place_count, const float low_m[3],
		       const float high_m[3])
{
	struct face_cells cells[CUBE_FACES];
	uint32_t side = 1u << (grid->level_count - 1);
	double area = 0, spacing, share = 0;

	*out = (struct sampling_forecast){ .point_count = sample_grid_points(grid) };
	for (int k = 0; k < 3; k++)
		area += 2.0 * (high_m[k] - low_m[k]) * (high_m[(k + 1) % 3] - low_m[(k + 1) % 3]);
	spacing = sqrt(area / place_count) / widening;
	for (uint32_t n = 0; n < out->point_count; n++) {
		uint32_t point[3];
		float at[3];

		sample_grid_point(grid, n, point);
		memset(cells, 0, sizeof(cells));
		sampler_point(at, grid, point);
		for (uint32_t p = 0; p < place_count; p++)
			see(cells, side, places_m[p], at, (float)spacing);
		if (seen_share(cells, side) > surrounded)
			continue;
		for (int face = 0; face < CUBE_FACES; face++) {
			count_tiles(out, &cells[face], side);
			share += (double)cells[face].place_count / place_count;
		}
	}
	out->triangle_share = out->face_count ? share / (double)out->face_count : 0;
}
