/* Texts that the terminal itself addresses to visitors: the invitation to touch, in all languages
 * at once, and the question whether somebody is still there. */
#ifndef GOPURA_UI_PROMPT_H
#define GOPURA_UI_PROMPT_H

#include <stdint.h>

#include "ui/bitmap.h"
#include "ui/theme.h"

/* Both draw into a new bitmap, owned by the caller, as large as needed and at most most_width_px
 * wide. They return the errors of bitmap_init. */

/* One line per language; a text that two languages share appears once. languages are borrowed for
 * the call. The theme's language changes during the call and is restored. */
must_check int prompt_draw_invitation(struct bitmap *out, struct theme *theme,
				      const char *const *languages, uint32_t language_count,
				      int most_width_px);
/* In the theme's language, with the seconds that are left for an answer. */
must_check int prompt_draw_question(struct bitmap *out, const struct theme *theme, int seconds_left,
				    int most_width_px);

#endif
