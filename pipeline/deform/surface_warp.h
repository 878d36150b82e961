/* Deformation along a parametric surface (paper 003, appendix C.1): the surface is flattened into
 * its tangent plane at its middle, so that lengths in it stay as far as they can. A place over the
 * plane goes over the surface, as far along its normal as it was from the plane; or the way back,
 * which lays a warped capture flat. */
#ifndef GOPURA_PIPELINE_DEFORM_SURFACE_WARP_H
#define GOPURA_PIPELINE_DEFORM_SURFACE_WARP_H

#include <stdbool.h>

#include "base/compiler.h"
#include "geometry/nurbs.h"
#include "pipeline/deform/warp.h"

struct surface_warp;

/* *out is owned by the caller; NULL on failure. surface: its arrays are borrowed for the lifetime
 * of *out. is_flattening: from the surface to the plane. -ENOMEM; -EDOM: the surface has no normal
 * in its middle. */
must_check int surface_warp_create(struct surface_warp **out, const struct nurbs_surface *surface,
				   bool is_flattening);
void surface_warp_destroy(struct surface_warp *warp); /* NULL is fine */

/* The warp is borrowed. What lies beyond the rim of the surface is squeezed onto it, so space does
 * not grow there. */
struct warp surface_warp_of(const struct surface_warp *warp);

/* Returns how much longer and shorter lines in the surface became when it was flattened: the most
 * and the least of all neighbouring places of a grid. */
void surface_warp_stretch(const struct surface_warp *warp, double *least, double *most);
/* Finds the control point that is nearest to a place that the warp takes. */
void surface_warp_nearest(const struct surface_warp *warp, const double place[3],
			  uint32_t point[2]);

#endif
