/* Estimates how much of the sky a place in the temple sees, from a grid of voxels 0.3 m wide into
 * which the sheets are drawn. It is built once and takes a few megabytes at any density. */
#ifndef GOPURA_PIPELINE_TEMPLE_TEMPLE_SKY_H
#define GOPURA_PIPELINE_TEMPLE_TEMPLE_SKY_H

#include "pipeline/temple/temple_plan.h"

struct sky;

/* Builds the grid. The caller owns *out; it is NULL on failure. The plan is only read during the
 * call. -ENOMEM. */
must_check int sky_create(struct sky **out, const struct plan *plan);
void sky_destroy(struct sky *sky); /* Frees it. NULL is fine. */
/* Returns 0 (enclosed) to 1 (the whole upper hemisphere visible). Notes in the grid what it
 * computes for it: one thread at a time. */
float sky_open(struct sky *sky, const float position_m[3], const float normal[3]);

#endif
