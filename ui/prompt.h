/* What the terminal itself says to whoever is there, or is not: the invitation to touch, in all
 * languages at once, and the question whether somebody is still there. */
#ifndef GOPURA_UI_PROMPT_H
#define GOPURA_UI_PROMPT_H

#include <stdint.h>

#include "ui/bitmap.h"
#include "ui/theme.h"

/* Fresh bitmaps, as large as they need, at most that wide. -ENOMEM and others of bitmap_init. */

/* A line a language, what two say alike once. languages are borrowed for the call. */
must_check int prompt_draw_invitation(struct bitmap *out, struct theme *theme,
				      const char *const *languages, uint32_t language_count,
				      int most_width_px);
/* In the theme's language, with the seconds that are left for an answer. */
must_check int prompt_draw_question(struct bitmap *out, const struct theme *theme, int seconds_left,
				    int most_width_px);

#endif
