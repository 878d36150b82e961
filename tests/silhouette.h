/* Which pixels of a panel show a model, told by a release's background. For pictures whose own
 * alpha is a guess (render/lumigraph/backdrop.h). */
#ifndef GOPURA_TESTS_SILHOUETTE_H
#define GOPURA_TESTS_SILHOUETTE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

/* By how much the background may differ in an image, which is compressed. */
enum { SILHOUETTE_LEVELS = 8 };

/* Sets alpha: 0 where a pixel has the background's colour, 255 elsewhere. */
static inline void silhouette_mark(uint8_t *rgba, size_t pixel_count, const uint8_t background[3])
{
	for (uint8_t *pixel = rgba; pixel < rgba + 4 * pixel_count; pixel += 4) {
		bool is_background = true;

		for (int k = 0; k < 3; k++)
			is_background &= abs(pixel[k] - background[k]) <= SILHOUETTE_LEVELS;
		pixel[3] = is_background ? 0 : 255;
	}
}

#endif
