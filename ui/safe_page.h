/* What a terminal shows while it cannot show its model: a gate tower that is lit storey by storey,
 * and the message in eight languages that it will be back soon. Everything moves slightly, so that
 * the terminal does not look dead and no pixel of the panel burns in.
 *
 * Drawn by Cairo alone. It needs no release and no GPU; without the catalogues of ui/translate.h
 * the message is in English only. */
#ifndef GOPURA_UI_SAFE_PAGE_H
#define GOPURA_UI_SAFE_PAGE_H

#include "ui/theme.h"

enum { SAFE_PAGE_LINES_MAX = 8 };

struct safe_page_line {
	PangoLayout *layout; /* owned */
	double width_px, height_px;
};

struct safe_page {
	struct theme theme;
	int width_px, height_px; /* size of the picture as the visitor sees it */
	struct safe_page_line lines[SAFE_PAGE_LINES_MAX];
	int line_count; /* languages for which a font is installed */
	double text_width_px, text_height_px;
};

/* Prepares texts for a picture of that size; end with safe_page_finish. Returns -ENOMEM. */
must_check int safe_page_init(struct safe_page *out, int width_px, int height_px);
void safe_page_finish(struct safe_page *page); /* zeroed is fine */
/* Draws the whole picture as it is at that time. time_ms may count from any moment. */
void safe_page_draw(const struct safe_page *page, cairo_t *context, int64_t time_ms);

#endif
