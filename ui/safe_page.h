/* What a terminal shows while it cannot show its temple: a gate tower that is lit storey by storey,
 * and in eight languages the word that it will be back. Everything on it moves a little, so that
 * whoever looks sees that somebody is at home, and no pixel of the panel is burnt in.
 *
 * Drawn by Cairo alone; of a release, a file or a GPU it needs nothing. */
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
	int width_px, height_px; /* of the picture as the visitor sees it */
	struct safe_page_line lines[SAFE_PAGE_LINES_MAX];
	int line_count; /* languages that have a font here */
	double text_width_px, text_height_px;
};

/* -ENOMEM. */
must_check int safe_page_init(struct safe_page *out, int width_px, int height_px);
void safe_page_finish(struct safe_page *page); /* zeroed is fine */
/* All of the picture as it is at that time; time_ms counts from anywhere. */
void safe_page_draw(const struct safe_page *page, cairo_t *context, int64_t time_ms);

#endif
