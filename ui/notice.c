/* Draws a notice page with the largest of a few type sizes at which everything fits. */
#include "ui/notice.h"

#include <math.h>
#include <stdio.h>

#include "ui/theme.h"

/* Millimetres, at scale 1. */
#define PADDING_MM   9.0f
#define BAR_MM       2.2f
#define GAP_MM       2.6f
#define MARK_MM      2.4f   /* space between a mark and its text */
#define NARROWEST_MM 85.0f  /* the panel is treated as at least this wide */
#define WIDEST_MM    230.0f /* longest line of text: longer ones are hard to follow */

/* Type scales, largest first. The last is the smallest that can be read at arm's length. */
static const float scales[] = { 1.5f, 1.25f, 1.0f, 0.8f, 0.65f };

struct page {
	const struct theme *theme;
	cairo_t *context;
	int x_px, width_px, mark_px;
	bool drawn; /* false: only measure */
};

/* Draws or measures a text that begins at y_px. Returns its height. */
static int put_text(const struct page *page, enum text_style style, struct colour colour,
		    const char *text, int x_px, int y_px)
{
	const int width_px = page->x_px + page->width_px - x_px;
	PangoLayout *layout = theme_layout(page->theme, style, text, width_px > 1 ? width_px : 1);
	int height_px;

	if (page->drawn) {
		theme_set_source(page->context, colour, 1);
		cairo_move_to(page->context, x_px, y_px);
		pango_cairo_show_layout(page->context, layout);
	}
	pango_layout_get_pixel_size(layout, NULL, &height_px);
	g_object_unref(layout);
	return height_px;
}

static int text_width_px(const struct theme *theme, enum text_style style, const char *text)
{
	PangoLayout *layout = theme_layout(theme, style, text, -1);
	int width_px;

	pango_layout_get_pixel_size(layout, &width_px, NULL);
	g_object_unref(layout);
	return width_px;
}

/* Sets where the texts of the items begin: to the right of the widest mark. */
static void measure_marks(struct page *page, const struct notice *notice)
{
	page->mark_px = 0;
	for (uint32_t i = 0; i < notice->count; i++) {
		const int width_px =
			text_width_px(page->theme, TEXT_HEADING_3, notice->items[i].mark);

		if (width_px > page->mark_px)
			page->mark_px = width_px;
	}
	if (page->mark_px > 0)
		page->mark_px += theme_px(page->theme, MARK_MM);
}

static int put_item(const struct page *page, const struct notice_item *item, int y_px)
{
	put_text(page, TEXT_HEADING_3, theme_accent, item->mark, page->x_px, y_px);
	return put_text(page, TEXT_BODY, theme_ink, item->text, page->x_px + page->mark_px, y_px);
}

static int put_more(const struct page *page, uint32_t count, int y_px)
{
	char text[64];

	if (count == 0)
		return 0;
	snprintf(text, sizeof(text), "and %u more", count);
	return put_text(page, TEXT_BODY, theme_ink_soft, text, page->x_px + page->mark_px, y_px);
}

static int put_foot(const struct page *page, const struct notice *notice, int y_px)
{
	const int gap_px = theme_px(page->theme, GAP_MM);

	if (page->drawn) {
		theme_set_source(page->context, theme_line, 1);
		cairo_rectangle(page->context, page->x_px, y_px, page->width_px,
				theme_px(page->theme, 0.3f));
		cairo_fill(page->context);
	}
	return gap_px + put_text(page, TEXT_CAPTION, theme_ink_soft, notice->foot, page->x_px,
				 y_px + gap_px);
}

/* Draws or measures the page with its first `count` items, from y_px on. Returns its height. */
static int put_page(const struct page *page, const struct notice *notice, uint32_t count, int y_px)
{
	const int began_px = y_px, gap_px = theme_px(page->theme, GAP_MM);

	y_px += put_text(page, TEXT_HEADING_1, theme_ink, notice->title, page->x_px, y_px);
	y_px += gap_px / 2;
	y_px += put_text(page, TEXT_CAPTION, theme_ink_soft, notice->lead, page->x_px, y_px);
	y_px += 2 * gap_px;
	for (uint32_t i = 0; i < count; i++)
		y_px += put_item(page, &notice->items[i], y_px) + gap_px;
	if (count < notice->count || notice->dropped > 0)
		y_px += put_more(page, notice->count - count + notice->dropped, y_px) + gap_px;
	y_px += gap_px / 2;
	y_px += put_foot(page, notice, y_px);
	return y_px - began_px;
}

static void lay_out(struct page *page, const struct notice *notice, int width_px)
{
	const int padding_px = theme_px(page->theme, PADDING_MM);
	const int left_px = theme_px(page->theme, BAR_MM) + padding_px;
	const int widest_px = theme_px(page->theme, WIDEST_MM);
	const int room_px = width_px - left_px - padding_px;

	page->width_px = room_px < widest_px ? room_px : widest_px;
	page->x_px = left_px + (room_px - page->width_px) / 2;
	measure_marks(page, notice);
}

static void draw_paper(const struct page *page, int height_px)
{
	theme_set_source(page->context, theme_paper, 1);
	cairo_paint(page->context);
	theme_set_source(page->context, theme_accent, 1);
	cairo_rectangle(page->context, 0, 0, theme_px(page->theme, BAR_MM), height_px);
	cairo_fill(page->context);
}

/* Draws the page at the page's type size. Returns false, with nothing drawn, if not everything
 * fits. With `forced`, draws as many items as fit and returns true. */
static bool draw_at(struct page *page, const struct notice *notice, bool forced, int width_px,
		    int height_px, uint32_t *count)
{
	const int padding_px = theme_px(page->theme, PADDING_MM);
	const int room_px = height_px - 2 * padding_px;
	int used_px;

	lay_out(page, notice, width_px);
	page->drawn = false;
	*count = notice->count;
	used_px = put_page(page, notice, *count, 0);
	while (forced && used_px > room_px && *count > 0)
		used_px = put_page(page, notice, --*count, 0);
	if (used_px > room_px && !forced)
		return false;
	page->drawn = true;
	draw_paper(page, height_px);
	/* A little above the middle, where people look first. */
	put_page(page, notice, *count,
		 padding_px + (room_px > used_px ? (room_px - used_px) * 2 / 5 : 0));
	return true;
}

int notice_draw(struct bitmap *out, const struct notice *notice, float px_per_mm, int width_px,
		int height_px, uint32_t *shown)
{
	const int shorter_px = width_px < height_px ? width_px : height_px;
	/* Large panels have large pixels. Letters need enough of them, however large they
	 * become. */
	const float mm_px = fmaxf(theme_guess_px_per_mm(width_px, height_px),
				  fminf(px_per_mm, (float)shorter_px / NARROWEST_MM));
	uint32_t count = 0;
	bool done = false;
	int rc = bitmap_init(out, width_px, height_px);

	for (size_t i = 0; rc == 0 && !done && i < ARRAY_COUNT(scales); i++) {
		struct theme theme;
		struct page page = { .theme = &theme };

		rc = theme_init(&theme, mm_px * scales[i], "en");
		if (rc < 0)
			break;
		page.context = bitmap_begin(out);
		done = draw_at(&page, notice, i + 1 == ARRAY_COUNT(scales), width_px, height_px,
			       &count);
		bitmap_end(out, page.context);
		theme_finish(&theme);
	}
	if (rc < 0)
		bitmap_finish(out);
	if (shown)
		*shown = count;
	return rc;
}
