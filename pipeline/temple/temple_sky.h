/* How much of the sky a place in the temple sees: an estimate from a grid of voxels 0.3 m wide that
 * the sheets are drawn into. Made once, a few megabytes whatever the density. */
#ifndef GOPURA_PIPELINE_TEMPLE_TEMPLE_SKY_H
#define GOPURA_PIPELINE_TEMPLE_TEMPLE_SKY_H

#include "pipeline/temple/temple_plan.h"

struct sky;

must_check int sky_create(struct sky **out, const struct plan *plan);
void sky_destroy(struct sky *sky); /* NULL is fine */
/* 0 (closed in) to 1 (the whole upper hemisphere open). */
float sky_open(const struct sky *sky, const float position_m[3], const float normal[3]);

#endif
