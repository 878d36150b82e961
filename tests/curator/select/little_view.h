/* A view made by a test: a wall, and on it a raised square whose sides are steps in depth. */
#ifndef GOPURA_TESTS_CURATOR_SELECT_LITTLE_VIEW_H
#define GOPURA_TESTS_CURATOR_SELECT_LITTLE_VIEW_H

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "curator/select/view_image.h"

enum { LITTLE_WIDTH = 160, LITTLE_HEIGHT = 120, LITTLE_PIXELS = LITTLE_WIDTH * LITTLE_HEIGHT };
/* The square, and the sky above the wall. */
enum { SQUARE_LEFT = 50, SQUARE_TOP = 40, SQUARE_SIDE = 50, SKY_ROWS = 10 };

static inline bool little_in_square(uint32_t x, uint32_t y)
{
	return x >= SQUARE_LEFT && x < SQUARE_LEFT + SQUARE_SIDE && y >= SQUARE_TOP &&
	       y < SQUARE_TOP + SQUARE_SIDE;
}

/* The square differs from the wall by a step of depth (metres of 10), its colour and its normal,
 * each if wanted. The arrays are freed by little_view_finish. */
static inline struct view_image little_view(float step_m, bool coloured, bool turned)
{
	struct view_image image = { .width_px = LITTLE_WIDTH,
				    .height_px = LITTLE_HEIGHT,
				    .px_per_radian = 150 };

	image.colours = calloc(LITTLE_PIXELS, sizeof(*image.colours));
	image.normals = calloc(LITTLE_PIXELS, sizeof(*image.normals));
	image.inverse_m = calloc(LITTLE_PIXELS, sizeof(*image.inverse_m));
	for (uint32_t y = SKY_ROWS; y < LITTLE_HEIGHT; y++) {
		for (uint32_t x = 0; x < LITTLE_WIDTH; x++) {
			const uint32_t at = y * LITTLE_WIDTH + x;
			const bool in = little_in_square(x, y);

			memset(image.colours[at], in && coloured ? 60 : 150, 3);
			image.normals[at][0] = in && turned ? 90 : 0;
			image.normals[at][1] = in && turned ? 90 : 127;
			/* a wall that leans: depth changes, but evenly */
			image.inverse_m[at] =
				1 / (10 - (in ? step_m : 0)) * (1 + (float)x / LITTLE_WIDTH / 3);
		}
	}
	return image;
}

static inline void little_view_finish(struct view_image *image)
{
	free(image->colours);
	free(image->normals);
	free(image->inverse_m);
}

#endif
