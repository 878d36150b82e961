/* Makes a picture of a raster with 1 or 2 x 2 samples per pixel: the scan's colours or the
 * procedural material, times the light. The material is computed once for all samples of a pixel
 * that lie together, except detail finer than a pixel, which is averaged. */
#ifndef GOPURA_PIPELINE_SAMPLES_RESOLVE_H
#define GOPURA_PIPELINE_SAMPLES_RESOLVE_H

#include "pipeline/samples/drawing.h"
#include "pipeline/samples/raster.h"

struct resolve;

/* samples: per pixel and axis, 1 or 2. The raster, which has colours unless they are procedural, is
 * borrowed for the lifetime of *out, which the caller owns; NULL on failure. Returns -ENOMEM. */
must_check int resolve_create(struct resolve **out, const struct raster *raster,
			      const struct drawing_options *drawn, int samples);
void resolve_destroy(struct resolve *resolve); /* NULL is fine */

/* Sets a picture, 4 bytes per pixel, row 0 on top, from what was drawn with that camera. rgb is the
 * mean of the samples that show anything, black if none does; alpha is as shading.h has it. */
void resolve_take(struct resolve *resolve, const struct camera *camera, uint8_t (*rgba)[4]);

#endif
