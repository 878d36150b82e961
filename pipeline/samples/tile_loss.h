/* What a tile loses when it is encoded, by structural similarity (Wang et al. 2004). */
#ifndef GOPURA_PIPELINE_SAMPLES_TILE_LOSS_H
#define GOPURA_PIPELINE_SAMPLES_TILE_LOSS_H

#include <stdint.h>

#include "format/samples.h"

/* A tile is compared in windows of 8 x 8 pixels, row by row. */
enum {
	TILE_WINDOW_PX = 8,
	TILE_WINDOW_SIDE = SAMPLE_IMAGE_PX / TILE_WINDOW_PX,
	TILE_WINDOWS = TILE_WINDOW_SIDE * TILE_WINDOW_SIDE,
	TILE_LOSS_WINDOW = 1000000 /* the loss of a window that has nothing of the original */
};

/* Returns the SSIM of brightness, at most 1, of the window whose first pixel that is. a and b:
 * SAMPLE_IMAGE_PX squared pixels of 3 bytes. */
double tile_window_ssim(const uint8_t *a, const uint8_t *b, uint32_t x0, uint32_t y0);

/* Returns the sum over windows of 1 - SSIM of brightness, in millionths. rgb and decoded:
 * SAMPLE_IMAGE_PX squared pixels of 3 bytes. covered: for each window, whether it counts. */
uint32_t tile_loss(const uint8_t *rgb, const uint8_t *decoded, const uint8_t covered[TILE_WINDOWS]);

#endif
