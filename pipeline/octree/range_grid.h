/* The grid of a range image: neighbours, normals and weights of its points (paper P1, section 4.2:
 * the normal of a point is the mean of those of the triangles with its neighbours on the grid).
 * Private to pipeline/octree. */
#ifndef GOPURA_PIPELINE_OCTREE_RANGE_GRID_H
#define GOPURA_PIPELINE_OCTREE_RANGE_GRID_H

#include "pipeline/octree/range_scan.h"

#define RANGE_NO_POINT UINT32_MAX

struct range_grid {
	uint32_t columns, rows;
	uint32_t *cells; /* columns * rows: the point seen there, or RANGE_NO_POINT; owned */
};

/* Returns whether, and along which axis, the lines of sight are parallel: how well a plane over
 * the grid explains each coordinate. RANGE_SIGHT_PLUS_X, _Y, _Z or RANGE_SIGHT_ORIGIN. The points'
 * places are those of the file. */
enum range_sight range_grid_sight(const struct range_grid *grid, const struct range_point *points);

/* Sets `normal` (towards the scanner), `spacing` and, by slope and the distance to the border of
 * what was seen, `weight`, of every point; `towards` is set. A point without a triangle gets weight
 * 0. Edges over a step in depth are no neighbours. Returns the median distance of neighbours, or
 * -ENOMEM. */
must_check int range_grid_orient(double *spacing, const struct range_grid *grid,
				 struct range_point *points, uint32_t count);

#endif
