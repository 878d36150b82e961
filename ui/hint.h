/* The help: how to touch the model, as moving pictures and words. One finger moves to and fro, two
 * move apart, a name is tapped. The pictures are understandable without the words. */
#ifndef GOPURA_UI_HINT_H
#define GOPURA_UI_HINT_H

#include <stdbool.h>
#include <stdint.h>

#include "ui/bitmap.h"
#include "ui/theme.h"

enum {
	HINT_FINGERS = 3,    /* one turns, two zoom */
	HINT_MOVES_MS = 6000 /* then they stop, and no more frames are drawn for them */
};

/* Draws the paths of the fingers and the words in the theme's language into a new bitmap, owned by
 * the caller, at most most_width_px wide. has_names: the model has names to tap, and the help
 * explains them. Returns the errors of bitmap_init. */
must_check int hint_draw(struct bitmap *out, const struct theme *theme, int most_width_px,
			 bool has_names);
/* Draws a fingertip into a new square bitmap, owned by the caller. */
must_check int hint_draw_finger(struct bitmap *out, const struct theme *theme);
/* Sets the centres of the fingers on the bitmap of hint_draw of that width, shown_ms after it
 * appeared. */
void hint_fingers(const struct theme *theme, int width_px, bool has_names, int64_t shown_ms,
		  float middles_px[HINT_FINGERS][2]);

#endif
