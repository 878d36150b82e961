/* A picture with coverage at every power of two of its size, with a filled background: push-pull
 * after Gortler et al. 1996 ("The Lumigraph"). The background is filled because coding would
 * otherwise ring at silhouettes, and bilinear filtering would bleed the background into them. */
#ifndef GOPURA_PIPELINE_SAMPLES_PYRAMID_H
#define GOPURA_PIPELINE_SAMPLES_PYRAMID_H

#include <stdbool.h>
#include <stdint.h>

#include "base/compiler.h"

enum { PYRAMID_LEVELS_MAX = 16, PYRAMID_SQUARE_MAX = 128 };

/* Square pictures; straight sRGB and coverage (255: all), row 0 on top. */
struct pyramid {
	uint32_t level_count; /* level 0 is the finest, the last is one pixel */
	uint32_t side_px[PYRAMID_LEVELS_MAX];
	uint8_t (*levels[PYRAMID_LEVELS_MAX])[4]; /* owned */
	uint64_t *weighed;                        /* owned; for pyramid_fill */
};

/* Allocates all levels. Returns -ENOMEM; zeroed then. */
must_check int pyramid_init(struct pyramid *pyramid, uint32_t side_px);
void pyramid_finish(struct pyramid *pyramid); /* NULL and zeroed are fine */

/* Level 0 has a picture whose alpha is as shading.h has it: replaces it by coverage, 0..255. Sets
 * *covered to the number of samples that show anything, and *backs to how many of these show a
 * back. */
void pyramid_count(struct pyramid *pyramid, uint64_t *covered, uint64_t *backs);
/* Returns true if a pixel of the square, which lies within the level, shows anything. */
bool pyramid_shows(const struct pyramid *pyramid, uint32_t level, uint32_t x, uint32_t y,
		   uint32_t side_px);
/* Makes all other levels with a box filter weighted by coverage. A pixel that shows anything has a
 * coverage of at least 1 at every level. */
void pyramid_reduce(struct pyramid *pyramid);
/* Sets the colours of uncovered pixels from the next coarser level. Coverage stays. */
void pyramid_fill(struct pyramid *pyramid);
/* Lays every level over a background of one colour instead; coverage stays. */
void pyramid_lay_over(struct pyramid *pyramid, const uint8_t rgb[3]);
/* Copies a square of a level, sharpened to compensate for the blur of display: texels are means
 * over their squares, and the kiosk interpolates between them. The square lies within the level;
 * side_px is at most PYRAMID_SQUARE_MAX. rgb: side_px * side_px * 3 bytes. */
void pyramid_sharpen(const struct pyramid *pyramid, uint32_t level, uint32_t x, uint32_t y,
		     uint32_t side_px, uint8_t *rgb);

#endif
