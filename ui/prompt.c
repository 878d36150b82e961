/* Draws the invitation to touch and the question whether somebody is still there. */
#include "ui/prompt.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "ui/icon.h"
#include "ui/translate.h"

/* The invitation's lines. Below the first, they stand in columns if there are many. */
enum { LINES_MAX = 24, COLUMN_LINES = 7, COLUMNS_MAX = 3 };

#define PADDING_MM 5.0f
#define ICON_MM    16.0f
#define LINE_MM    1.6f /* space between two lines */
#define BUTTON_MM  12.0f

/* Translators: shown while nobody is there, in every language of the terminal. */
static const char invitation[] = N_("Touch to explore");

static void measure(PangoLayout *layout, int *width_px, int *height_px)
{
	pango_layout_get_pixel_size(layout, width_px, height_px);
}

static void draw_text(cairo_t *context, PangoLayout *layout, double x, double y)
{
	cairo_move_to(context, x, y);
	pango_cairo_show_layout(context, layout);
}

static bool is_said(const char *const *languages, uint32_t before, const char *text)
{
	for (uint32_t i = 0; i < before; i++)
		if (strcmp(translate(languages[i], invitation), text) == 0)
			return true;
	return false;
}

/* Lays out one line per language, the first in large type, each by the rules of its own
 * language. */
static uint32_t lay_out_lines(PangoLayout **lines, struct theme *theme,
			      const char *const *languages, uint32_t language_count, int room_px)
{
	char language[sizeof(theme->language)];
	uint32_t count = 0;

	memcpy(language, theme->language, sizeof(language));
	for (uint32_t i = 0; i < language_count && count < LINES_MAX; i++) {
		const char *text = translate(languages[i], invitation);

		if (is_said(languages, i, text))
			continue;
		theme_set_language(theme, languages[i]);
		lines[count] =
			theme_layout(theme, count == 0 ? TEXT_TITLE : TEXT_CAPTION, text, -1);
		theme_limit_lines(lines[count++], room_px, 1);
	}
	theme_set_language(theme, language);
	return count;
}

/* Lines and their sizes in pixels. The first line is above all columns. */
struct lines {
	PangoLayout *lines[LINES_MAX];
	uint32_t count;
	int columns, rows, column_width, first_height, row_heights[COLUMN_LINES];
};

/* Uses as many columns as fit. Lines that do not fit are left out. */
static struct lines place_lines(struct theme *theme, const char *const *languages,
				uint32_t language_count, int room_px, int gap)
{
	struct lines all = { 0 };
	int width;

	all.count = lay_out_lines(all.lines, theme, languages, language_count, room_px);
	measure(all.lines[0], &all.column_width, &all.first_height);
	for (uint32_t i = 1; i < all.count; i++) {
		measure(all.lines[i], &width, NULL);
		all.column_width = width > all.column_width ? width : all.column_width;
	}
	all.columns = ((int)all.count - 1 + COLUMN_LINES - 1) / COLUMN_LINES;
	all.columns = all.columns < COLUMNS_MAX ? all.columns : COLUMNS_MAX;
	while (all.columns > 1 &&
	       all.columns * all.column_width + (all.columns - 1) * 2 * gap > room_px)
		all.columns--;
	if (all.columns < 1)
		all.columns = 1;
	all.rows = ((int)all.count - 1 + all.columns - 1) / all.columns;
	all.rows = all.rows < COLUMN_LINES ? all.rows : COLUMN_LINES;
	for (int i = 1; i < (int)all.count && i <= all.rows * all.columns; i++) {
		int *row_height = &all.row_heights[(i - 1) % all.rows], height;

		measure(all.lines[i], NULL, &height);
		*row_height = height > *row_height ? height : *row_height;
	}
	return all;
}

int prompt_draw_invitation(struct bitmap *out, struct theme *theme, const char *const *languages,
			   uint32_t language_count, int most_width_px)
{
	const int padding = theme_px(theme, PADDING_MM), icon = theme_px(theme, ICON_MM);
	const int gap = theme_px(theme, LINE_MM);
	const int room_px = most_width_px - 3 * padding - icon;
	const struct lines all =
		place_lines(theme, languages, language_count, room_px > 1 ? room_px : 1, gap);
	const int text_width = all.columns * all.column_width + (all.columns - 1) * 2 * gap;
	int text_height = all.first_height, rc;

	for (int row = 0; row < all.rows; row++)
		text_height += gap + all.row_heights[row];
	rc = bitmap_init(out, text_width + icon + 3 * padding,
			 (text_height > icon ? text_height : icon) + 2 * padding);
	if (rc == 0) {
		cairo_t *context = bitmap_begin(out);
		const double x = 2 * padding + icon, top = (out->height_px - text_height) / 2.0;
		double y = top;

		theme_rounded(context, 0, 0, out->width_px, out->height_px,
			      theme_px(theme, THEME_RADIUS_MM));
		theme_set_source(context, theme_night, THEME_CHIP_ALPHA);
		cairo_fill(context);
		theme_set_source(context, theme_night_text, 1);
		icon_draw(context, ICON_TAP, padding + icon / 2.0, out->height_px / 2.0, icon);
		/* Right-to-left lines end at the same right edge. */
		pango_layout_set_width(all.lines[0], text_width * PANGO_SCALE);
		draw_text(context, all.lines[0], x, y);
		for (int i = 1; i < (int)all.count && i <= all.rows * all.columns; i++) {
			const int column = (i - 1) / all.rows, row = (i - 1) % all.rows;

			y = row == 0 ? top + all.first_height + gap
				     : y + all.row_heights[row - 1] + gap;
			pango_layout_set_width(all.lines[i], all.column_width * PANGO_SCALE);
			draw_text(context, all.lines[i], x + column * (all.column_width + 2 * gap),
				  y);
		}
		bitmap_end(out, context);
	}
	for (uint32_t i = 0; i < all.count; i++)
		g_object_unref(all.lines[i]);
	return rc;
}

static void draw_button(cairo_t *context, PangoLayout *label, double x, double y, int width_px,
			int height_px)
{
	int label_px, text_px;

	theme_rounded(context, x, y, width_px, height_px, height_px / 2.0);
	theme_set_source(context, theme_accent, 1);
	cairo_fill(context);
	measure(label, &label_px, &text_px);
	theme_set_source(context, theme_paper, 1);
	draw_text(context, label, x + (width_px - label_px) / 2.0, y + (height_px - text_px) / 2.0);
}

int prompt_draw_question(struct bitmap *out, const struct theme *theme, int seconds_left,
			 int most_width_px)
{
	const int padding = theme_px(theme, PADDING_MM), gap = 2 * theme_px(theme, LINE_MM);
	const int room_px = most_width_px > 3 * padding ? most_width_px - 2 * padding : padding;
	/* Translators: asked of a visitor who has touched nothing for a minute. */
	const char *texts[] = { translate(theme->language, "Are you still there?"), NULL,
				translate(theme->language, "Continue") };
	enum { QUESTION, COUNT_DOWN, BUTTON, COUNT };
	int width[COUNT], height[COUNT], button_px, wide_px, rc;
	PangoLayout *layouts[COUNT];
	char count_down[160];

	snprintf(count_down, sizeof(count_down),
		 /* Translators: counts down from 15 while the question is shown. */
		 translate_plural(theme->language, "Returning to the start in %d second",
				  "Returning to the start in %d seconds",
				  (unsigned long)seconds_left),
		 seconds_left);
	texts[COUNT_DOWN] = count_down;
	for (int i = 0; i < COUNT; i++) {
		static const enum text_style styles[] = { TEXT_TITLE, TEXT_CAPTION, TEXT_BUTTON };

		layouts[i] = theme_layout(theme, styles[i], texts[i], -1);
		theme_limit_lines(layouts[i], room_px, 2);
		measure(layouts[i], &width[i], &height[i]);
		/* Otherwise right-to-left text would begin at the far end of the available
		 * width. */
		pango_layout_set_width(layouts[i], width[i] * PANGO_SCALE);
	}
	button_px = width[BUTTON] + 4 * padding;
	wide_px = width[QUESTION] > width[COUNT_DOWN] ? width[QUESTION] : width[COUNT_DOWN];
	wide_px = wide_px > button_px ? wide_px : button_px;
	rc = bitmap_init(out, wide_px + 2 * padding,
			 height[QUESTION] + height[COUNT_DOWN] + 3 * gap + 2 * padding +
				 theme_px(theme, BUTTON_MM));
	if (rc == 0) {
		cairo_t *context = bitmap_begin(out);
		double y = padding;

		theme_rounded(context, 0, 0, out->width_px, out->height_px,
			      theme_px(theme, THEME_RADIUS_MM));
		theme_set_source(context, theme_paper, 1);
		cairo_fill(context);
		theme_set_source(context, theme_ink, 1);
		draw_text(context, layouts[QUESTION], (out->width_px - width[QUESTION]) / 2.0, y);
		y += height[QUESTION] + gap;
		theme_set_source(context, theme_ink_soft, 1);
		draw_text(context, layouts[COUNT_DOWN], (out->width_px - width[COUNT_DOWN]) / 2.0,
			  y);
		y += height[COUNT_DOWN] + 2 * gap;
		draw_button(context, layouts[BUTTON], (out->width_px - button_px) / 2.0, y,
			    button_px, theme_px(theme, BUTTON_MM));
		bitmap_end(out, context);
	}
	for (int i = 0; i < COUNT; i++)
		g_object_unref(layouts[i]);
	return rc;
}
