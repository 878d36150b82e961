/* Questions about the space in which an eye may be (format/solid.h). Each takes a walk down the
 * octree for every cell that it meets, so it grows with the logarithm of the model's size (paper
 * P1, section 7). What lies outside of the octree is free. Pure. */
#ifndef GOPURA_GEOMETRY_SOLID_SPACE_H
#define GOPURA_GEOMETRY_SOLID_SPACE_H

#include <stdbool.h>

#include "format/solid.h"

/* Returns whether an eye may be at a point. */
bool solid_is_free(const struct solid *solid, const float point_m[3]);
/* Returns the distance from a point to the first full cell along a direction, a unit vector; 0
 * within one, INFINITY: none within most_m. *axis, unless NULL, becomes the axis that is
 * perpendicular to the side of the cell that is met, or -1. */
float solid_reach(const struct solid *solid, const float from_m[3], const float direction[3],
		  float most_m, int *axis);
/* Returns whether the straight way between two points is free, both included. */
bool solid_way_is_free(const struct solid *solid, const float from_m[3], const float to_m[3]);
/* Finds the free point of the octree nearest to a point, up to a hundredth of the smallest cell; a
 * point that is free stays as it is. Returns false if none is within most_m. */
bool solid_nearest_free(const struct solid *solid, const float point_m[3], float most_m,
			float out_m[3]);

#endif
