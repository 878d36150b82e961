/* The place of a scan among others, as aligning programs write it: a 4x4 matrix in the unit and
 * axes of the files, applied to columns (x y z 1). Its last row is 0 0 0 1 and is not kept. */
#ifndef GOPURA_PIPELINE_IMPORT_TRANSFORM_H
#define GOPURA_PIPELINE_IMPORT_TRANSFORM_H

#include <stdbool.h>

#include "base/compiler.h"

struct transform {
	double rows[3][4];
};

/* Takes the 16 numbers of a matrix, row by row. Returns NULL, or what is wrong with the matrix as a
 * phrase such as "holds a number that is not finite"; *out is then undefined. */
const char *transform_set(struct transform *out, const double numbers[16]);

/* to may be from. */
void transform_point(const struct transform *transform, const double from[3], double to[3]);

/* Returns whether it turns left into right, so that the corners of faces must change their order.
 */
bool transform_mirrors(const struct transform *transform);

#endif
