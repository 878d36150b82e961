/* The part of a rectangle that trimming contours leave, as trapezoids between lines of equal v. A
 * trapezoid has the corners of its neighbours on its sides, so triangles of both meet corner to
 * corner. Private to pipeline/scene. */
#ifndef GOPURA_PIPELINE_SCENE_VRML_TRIM_H
#define GOPURA_PIPELINE_SCENE_VRML_TRIM_H

#include <stdint.h>

#include "base/compiler.h"

enum { TRIM_EDGES_MAX = 4096 };

/* A side of a contour, from one place to another. */
struct trim_edge {
	double from[2], to[2]; /* u, v */
};

/* A triangle in u and v, counter-clockwise. */
typedef int (*trim_visit)(void *data, const double a[2], const double b[2], const double c[2]);

/* Calls visit for triangles that cover what an odd number of contours goes around. edges: of closed
 * contours, count at most TRIM_EDGES_MAX. Returns the first failure of visit, or -ENOMEM. */
must_check int trim_triangles(const struct trim_edge *edges, uint32_t count, trim_visit visit,
			      void *data);

#endif
