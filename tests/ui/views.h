/* A panel for the tests of single views: 1000 by 600 pixels, 5 to the millimetre, with a bar at the
 * lower left. */
#ifndef GOPURA_TESTS_UI_VIEWS_H
#define GOPURA_TESTS_UI_VIEWS_H

#include "tests/check.h"
#include "ui/layers.h"
#include "ui/screen.h"

enum { VIEW_LAYERS_MAX = 80 };

/* theme is initialized here; end with theme_finish. */
static inline struct screen make_screen(struct theme *theme, const char *language)
{
	CHECK(theme_init(theme, 5, language) == 0);
	return (struct screen){ .theme = theme,
				.width_px = 1000,
				.height_px = 600,
				.bar = { 10, 535, 400, 55 },
				.scene = { 0, 0, 1000, 600 } };
}

/* The middle of a rectangle. */
static inline float middle_x(struct rect rect)
{
	return (float)rect.x_px + (float)rect.width_px / 2;
}

static inline float middle_y(struct rect rect)
{
	return (float)rect.y_px + (float)rect.height_px / 2;
}

/* Of the columns from..to, of the rows above `below`, shares of the bitmap; what is as light, or
 * dark, as text. */
static inline uint32_t text_pixels(const struct bitmap *bitmap, double from, double to,
				   double below, bool light)
{
	uint32_t count = 0;

	for (int y = 0; y < (int)(bitmap->height_px * below); y++)
		for (int x = (int)(bitmap->width_px * from); x < (int)(bitmap->width_px * to);
		     x++) {
			const uint8_t *p =
				bitmap->pixels + (size_t)y * bitmap->stride_bytes + 4 * (size_t)x;

			count += p[3] == 255 && (light ? p[0] > 200 : p[0] < 120);
		}
	return count;
}

#endif
