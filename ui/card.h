/* The card of a part: thumbnail, title, caption, and that there is more to read. The whole of it is
 * one target, but for the corner that closes it. */
#ifndef GOPURA_UI_CARD_H
#define GOPURA_UI_CARD_H

#include "ui/bitmap.h"
#include "ui/source.h"
#include "ui/theme.h"

struct card {
	const char *title, *caption;     /* borrowed for the call */
	const struct picture *thumbnail; /* NULL: none, or not here yet */
	bool has_thumbnail;              /* its place is kept */
	bool has_page;
};

/* At most width_px wide. */
void card_size(const struct theme *theme, int most_width_px, int *width_px, int *height_px);
/* A fresh bitmap of that size, with a shadow of card_shadow_px around it inside the size. */
must_check int card_draw(struct bitmap *out, const struct theme *theme, const struct card *card,
			 int width_px, int height_px);
/* The point, relative to the card's bitmap, is on the control that closes it. */
bool card_closes(const struct theme *theme, int width_px, float x_px, float y_px);

#endif
