/* How to touch the model, in pictures that move and in words: a finger that goes to and fro, two
 * that part, a name that is tapped. The pictures say it without the words. */
#ifndef GOPURA_UI_HINT_H
#define GOPURA_UI_HINT_H

#include <stdbool.h>
#include <stdint.h>

#include "ui/bitmap.h"
#include "ui/theme.h"

enum {
	HINT_FINGERS = 3,    /* one turns, two zoom */
	HINT_MOVES_MS = 6000 /* then they rest, and so does the panel */
};

/* The ways of the fingers and the words in the theme's language, a fresh bitmap as large as it
 * needs, at most that wide. Of names to tap it speaks where the model has some. -ENOMEM and others
 * of bitmap_init. */
must_check int hint_draw(struct bitmap *out, const struct theme *theme, int most_width_px,
			 bool has_names);
/* A fingertip, square. */
must_check int hint_draw_finger(struct bitmap *out, const struct theme *theme);
/* Where the fingers' middles are on hint_draw's bitmap of that width, so long after it came. */
void hint_fingers(const struct theme *theme, int width_px, bool has_names, int64_t shown_ms,
		  float middles_px[HINT_FINGERS][2]);

#endif
