/* Whether a deformation folds a surface over between its vertices. */
#ifndef GOPURA_PIPELINE_DEFORM_FOLD_CHECK_H
#define GOPURA_PIPELINE_DEFORM_FOLD_CHECK_H

#include "pipeline/deform/warp.h"
#include "pipeline/import/mesh.h"

/* Space that shrinks to less is folded; derivatives of surfaces are no more exact. */
#define FOLD_GROWTH_LEAST 1e-6

/* Computes how much space grows at a place, the determinant of the derivatives; below 0 it is
 * turned inside out. *to gets where the place goes. */
double fold_growth(const struct warp *warp, const double from[3], double to[3]);

/* Looks for a place within the triangles where space grows by no more than FOLD_GROWTH_LEAST. The
 * derivatives differ from those in the middle of a triangle by no more than the bound of the second
 * derivative times the distance, so where their least singular value in the middle is above that,
 * nothing folds in it. Else the triangle is divided, and its parts are judged, down to 1/64 of its
 * edges. A warp that knows what is safe is asked instead of its bound. The place that is found is
 * in the first triangle that has one, whatever the number of jobs. Returns 1 with a place; 0: none;
 * -ENOMEM. */
must_check int fold_find(double place[3], const struct mesh *mesh, const struct warp *warp,
			 uint32_t jobs);

#endif
