/* Lays out and draws the invitation, in columns if there are many languages. */
#include "ui/invitation_view.h"

#include <string.h>

#include "ui/icon.h"
#include "ui/translate.h"

/* Below the first line, the others stand in columns if there are many. */
enum { LINES_MAX = 24, COLUMN_LINES = 7, COLUMNS_MAX = 3 };

#define PADDING_MM 5.0f
#define ICON_MM    16.0f
#define LINE_MM    1.6f /* space between two lines */

/* Translators: shown while nobody is there, in every language of the terminal. */
static const char invitation[] = N_("Touch to explore");

void invitation_view_init(struct invitation_view *view, uint32_t *next_id)
{
	*view = (struct invitation_view){ 0 };
	sprites_init(&view->sprite, 1, next_id);
}

void invitation_view_finish(struct invitation_view *view)
{
	sprites_finish(&view->sprite, 1);
}

/* ---- layout ---- */

static void measure(PangoLayout *layout, int *width_px, int *height_px)
{
	pango_layout_get_pixel_size(layout, width_px, height_px);
}

static void draw_text(cairo_t *context, PangoLayout *layout, double x, double y)
{
	cairo_move_to(context, x, y);
	pango_cairo_show_layout(context, layout);
}

static bool is_said(const struct languages *languages, uint32_t before, const char *text)
{
	for (uint32_t i = 0; i < before; i++)
		if (strcmp(translate(languages->codes[i], invitation), text) == 0)
			return true;
	return false;
}

/* Lays out one line per language, the first in large type, each by the rules of its own
 * language. */
static uint32_t lay_out_lines(PangoLayout **lines, struct theme *theme,
			      const struct languages *languages, int room_px)
{
	char language[sizeof(theme->language)];
	uint32_t count = 0;

	memcpy(language, theme->language, sizeof(language));
	for (uint32_t i = 0; i < languages->count && count < LINES_MAX; i++) {
		const char *text = translate(languages->codes[i], invitation);

		if (is_said(languages, i, text))
			continue;
		theme_set_language(theme, languages->codes[i]);
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
static struct lines place_lines(struct theme *theme, const struct languages *languages, int room_px,
				int gap)
{
	struct lines all = { 0 };
	int width;

	all.count = lay_out_lines(all.lines, theme, languages, room_px);
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

/* ---- drawing ---- */

static void draw(struct sprite *sprite, const struct screen *screen, struct theme *theme,
		 const struct languages *languages)
{
	const int most_width_px = screen->width_px - 2 * screen_px(screen, THEME_GAP_MM);
	const int padding = theme_px(theme, PADDING_MM), icon = theme_px(theme, ICON_MM);
	const int gap = theme_px(theme, LINE_MM);
	const int room_px = most_width_px - 3 * padding - icon;
	const struct lines all = place_lines(theme, languages, room_px > 1 ? room_px : 1, gap);
	const int text_width = all.columns * all.column_width + (all.columns - 1) * 2 * gap;
	int text_height = all.first_height, width, height;
	cairo_t *context;

	for (int row = 0; row < all.rows; row++)
		text_height += gap + all.row_heights[row];
	width = text_width + icon + 3 * padding;
	height = (text_height > icon ? text_height : icon) + 2 * padding;
	context = sprite_begin(sprite, width, height);
	if (context) {
		const double x = 2 * padding + icon, top = (height - text_height) / 2.0;
		double y = top;

		theme_rounded(context, 0, 0, width, height, theme_px(theme, THEME_RADIUS_MM));
		theme_set_source(context, theme_night, THEME_CHIP_ALPHA);
		cairo_fill(context);
		theme_set_source(context, theme_night_text, 1);
		icon_draw(context, ICON_TAP, padding + icon / 2.0, height / 2.0, icon);
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
		sprite_end(sprite, context);
	}
	for (uint32_t i = 0; i < all.count; i++)
		g_object_unref(all.lines[i]);
}

/* ---- state ---- */

bool invitation_view_show(struct invitation_view *view, bool on)
{
	if (view->fade.on == on)
		return false;
	view->fade.on = on;
	return true;
}

void invitation_view_draw(struct invitation_view *view, const struct screen *screen,
			  struct theme *theme, const struct languages *languages)
{
	if (view->fade.on)
		draw(&view->sprite, screen, theme, languages);
}

struct rect invitation_view_rect(const struct invitation_view *view, const struct screen *screen)
{
	return screen_above_floor(screen, view->sprite.bitmap.width_px,
				  view->sprite.bitmap.height_px);
}

bool invitation_view_update(struct invitation_view *view, int64_t step_ms)
{
	return fade_advance(&view->fade, step_ms);
}

void invitation_view_layers(const struct invitation_view *view, const struct screen *screen,
			    struct layers *layers)
{
	const struct rect rect = invitation_view_rect(view, screen);

	layers_add_at(layers, &view->sprite, fade_eased(&view->fade), (float)rect.x_px,
		      (float)rect.y_px);
}
