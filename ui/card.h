/* The card of a part: thumbnail, title, caption and a hint that there is more to read. The whole
 * card is one touch target, except for the corner that closes it. */
#ifndef GOPURA_UI_CARD_H
#define GOPURA_UI_CARD_H

#include "ui/bitmap.h"
#include "ui/source.h"
#include "ui/theme.h"

struct card {
	const char *title, *caption;     /* borrowed for the call */
	const struct picture *thumbnail; /* NULL: none, or not arrived yet */
	bool has_thumbnail;              /* its place is reserved */
	/* Show "Read more". */
	bool has_page;
};

/* Sets the size of a card, at most most_width_px wide. */
void card_size(const struct theme *theme, int most_width_px, int *width_px, int *height_px);
/* Draws a card into a new bitmap of that size, owned by the caller. A shadow runs around the card
 * inside that size. Returns the errors of bitmap_init. */
must_check int card_draw(struct bitmap *out, const struct theme *theme, const struct card *card,
			 int width_px, int height_px);
/* Returns true if the point, relative to the card's bitmap, is on the control that closes it. */
bool card_closes(const struct theme *theme, int width_px, float x_px, float y_px);

#endif
