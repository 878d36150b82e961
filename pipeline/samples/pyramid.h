/* A picture with coverage at every half of its size, and its background filled in: push-pull after
 * Gortler et al. 1996 ("The Lumigraph"). Filled, because coding would ring at the silhouettes and
 * bilinear filtering would bleed the background into them. */
#ifndef GOPURA_PIPELINE_SAMPLES_PYRAMID_H
#define GOPURA_PIPELINE_SAMPLES_PYRAMID_H

#include <stdbool.h>
#include <stdint.h>

#include "base/compiler.h"

enum { PYRAMID_LEVELS_MAX = 16 };

/* Square; straight sRGB and coverage (255: all), row 0 on top. */
struct pyramid {
	uint32_t level_count; /* level 0 is the finest, the last is one pixel */
	uint32_t side_px[PYRAMID_LEVELS_MAX];
	uint8_t (*levels[PYRAMID_LEVELS_MAX])[4]; /* owned */
};

must_check int pyramid_init(struct pyramid *pyramid, uint32_t side_px);
void pyramid_finish(struct pyramid *pyramid); /* NULL and zeroed are fine */

/* Level 0 from a picture as shading_take gives it. Gives how many of its samples show anything, and
 * how many of these a back. */
void pyramid_set(struct pyramid *pyramid, const uint8_t *rgba, uint64_t *covered, uint64_t *backs);
/* All other levels by box filter, weighted by coverage; a pixel that shows anything has coverage
 * of at least 1 at every level. */
void pyramid_reduce(struct pyramid *pyramid);
/* Colours of uncovered pixels from the next coarser level; coverage stays. */
void pyramid_fill(struct pyramid *pyramid);
/* Every level, by what showing it will blur: texels are means over their squares, and between them
 * the kiosk interpolates. Colours that leave 0..255 stay at its ends. Last of all. -ENOMEM. */
must_check int pyramid_sharpen(struct pyramid *pyramid);

#endif
