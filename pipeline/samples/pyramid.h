/* A picture with coverage at every power of two of its size, with a filled background: push-pull
 * after Gortler et al. 1996 ("The Lumigraph"). The background is filled because coding would
 * otherwise ring at silhouettes, and bilinear filtering would bleed the background into them. */
#ifndef GOPURA_PIPELINE_SAMPLES_PYRAMID_H
#define GOPURA_PIPELINE_SAMPLES_PYRAMID_H

#include <stdbool.h>
#include <stdint.h>

#include "base/compiler.h"

enum { PYRAMID_LEVELS_MAX = 16 };

/* Square pictures; straight sRGB and coverage (255: all), row 0 on top. */
struct pyramid {
	uint32_t level_count; /* level 0 is the finest, the last is one pixel */
	uint32_t side_px[PYRAMID_LEVELS_MAX];
	uint8_t (*levels[PYRAMID_LEVELS_MAX])[4]; /* owned */
};

/* Allocates all levels. Returns -ENOMEM; zeroed then. */
must_check int pyramid_init(struct pyramid *pyramid, uint32_t side_px);
void pyramid_finish(struct pyramid *pyramid); /* NULL and zeroed are fine */

/* Sets level 0 from a picture of shading_take. Sets *covered to the number of its samples that show
 * anything, and *backs to how many of these show a back. */
void pyramid_set(struct pyramid *pyramid, const uint8_t *rgba, uint64_t *covered, uint64_t *backs);
/* Makes all other levels with a box filter weighted by coverage. A pixel that shows anything has a
 * coverage of at least 1 at every level. */
void pyramid_reduce(struct pyramid *pyramid);
/* Sets the colours of uncovered pixels from the next coarser level. Coverage stays. */
void pyramid_fill(struct pyramid *pyramid);
/* Sharpens every level to compensate for the blur of display: texels are means over their squares,
 * and the kiosk interpolates between them. Colours are clamped to 0..255. Call it last. Returns
 * -ENOMEM. */
must_check int pyramid_sharpen(struct pyramid *pyramid);

#endif
