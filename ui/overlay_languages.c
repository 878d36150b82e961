/* The menu of languages, used if the bar has one button for all of them. It stands above the bar
 * and over whatever is open, so that switching the language does not close the page. */
#include "ui/overlay_state.h"
#include "ui/strings.h"

#define COLUMN_MM  38.0f /* width of a name; down to NARROW_MM if there are many */
#define NARROW_MM  22.0f
#define ROW_MM     11.0f
#define PADDING_MM 2.0f

enum { COLUMNS = 3 };

struct grid {
	struct overlay_rect all;
	int columns, column_px, row_px;
};

static int px(const struct overlay *overlay, float mm)
{
	return theme_px(&overlay->theme, mm);
}

void overlay_show_languages(struct overlay *overlay, bool on)
{
	struct languages_menu *menu = &overlay->menu;

	on = on && overlay->chrome.menu;
	if (on == menu->fade.on)
		return;
	menu->fade.on = on;
	menu->dirty |= on;
	overlay->chrome_dirty = true;
}

bool overlay_choosing_language(const struct overlay *overlay)
{
	return overlay->menu.fade.on;
}

/* ---- layout ---- */

static int rows_of(const struct overlay *overlay, int columns)
{
	return ((int)overlay->language_count + columns - 1) / columns;
}

static struct grid lay_out(const struct overlay *overlay)
{
	const struct overlay_rect bar = overlay_chrome_rect(overlay);
	const int gap = px(overlay, THEME_GAP_MM), padding = px(overlay, PADDING_MM);
	const int reach = overlay_reach_top(overlay), target = px(overlay, THEME_TARGET_MM);
	const int high = bar.y_px - 2 * gap - 2 * padding - reach;
	const int wide = overlay->width_px - 2 * bar.x_px - 2 * padding;
	const int column_px = theme_text_px(&overlay->theme, COLUMN_MM);
	struct grid grid = { .row_px = theme_text_px(&overlay->theme, ROW_MM) };
	int rows;

	grid.columns = wide / column_px < COLUMNS ? wide / column_px : COLUMNS;
	if (grid.columns < 1)
		grid.columns = 1;
	/* If rows do not fit, add columns before rows shrink below a touch target. */
	while (rows_of(overlay, grid.columns) * target > high &&
	       (grid.columns + 1) * px(overlay, NARROW_MM) <= wide)
		grid.columns++;
	rows = rows_of(overlay, grid.columns);
	if (rows * grid.row_px > high)
		grid.row_px = high / rows > target ? high / rows : target;
	grid.column_px = wide / grid.columns < column_px ? wide / grid.columns : column_px;
	grid.all.width_px = grid.columns * grid.column_px + 2 * padding;
	grid.all.height_px = rows * grid.row_px + 2 * padding;
	grid.all.x_px = bar.x_px;
	grid.all.y_px = bar.y_px - gap - grid.all.height_px;
	return grid;
}

struct overlay_rect overlay_languages_rect(const struct overlay *overlay)
{
	return lay_out(overlay).all;
}

/* Languages are listed row by row. A tap beside the menu closes it. */
struct overlay_action overlay_languages_tap(const struct overlay *overlay, float x_px, float y_px)
{
	const struct grid grid = lay_out(overlay);
	const int padding = px(overlay, PADDING_MM);
	struct overlay_action action = { .kind = OVERLAY_LANGUAGES, .part = -1 };
	int column, row, language;

	if (!overlay_rect_holds(grid.all, x_px, y_px))
		return action;
	column = ((int)x_px - grid.all.x_px - padding) / grid.column_px;
	row = ((int)y_px - grid.all.y_px - padding) / grid.row_px;
	column = column < grid.columns ? column : grid.columns - 1;
	language = row * grid.columns + column;
	if (language >= (int)overlay->language_count) {
		action.kind = OVERLAY_SWALLOWED;
	} else if (language != overlay->language) {
		action.kind = OVERLAY_LANGUAGE;
		action.language = overlay->languages[language];
	}
	return action;
}

/* ---- drawing ---- */

static void draw_name(const struct overlay *overlay, cairo_t *context, const struct grid *grid,
		      int language)
{
	const int padding = px(overlay, PADDING_MM), inset = px(overlay, THEME_GAP_MM) / 2;
	const int x = padding + language % grid->columns * grid->column_px;
	const int y = padding + language / grid->columns * grid->row_px;
	const bool is_set = language == overlay->language;
	PangoLayout *layout = theme_layout(&overlay->theme, TEXT_BUTTON,
					   ui_endonym(overlay->languages[language]), -1);
	int height_px;

	if (is_set) {
		theme_rounded(context, x + inset, y + inset, grid->column_px - 2 * inset,
			      grid->row_px - 2 * inset, px(overlay, THEME_RADIUS_MM));
		theme_set_source(context, theme_accent, 1);
		cairo_fill(context);
	}
	theme_limit_lines(layout, grid->column_px - 4 * inset, 1);
	pango_layout_set_alignment(layout, PANGO_ALIGN_CENTER);
	pango_layout_get_pixel_size(layout, NULL, &height_px);
	theme_set_source(context, is_set ? theme_paper : theme_ink, 1);
	cairo_move_to(context, x + 2 * inset, y + (grid->row_px - height_px) / 2.0);
	pango_cairo_show_layout(context, layout);
	g_object_unref(layout);
}

static void draw_menu(struct overlay *overlay)
{
	const struct grid grid = lay_out(overlay);
	cairo_t *context =
		overlay_begin(overlay, BITMAP_LANGUAGES, grid.all.width_px, grid.all.height_px);

	if (!context)
		return;
	theme_rounded(context, 0, 0, grid.all.width_px, grid.all.height_px,
		      px(overlay, THEME_RADIUS_MM));
	theme_set_source(context, theme_paper, 1);
	cairo_fill_preserve(context);
	theme_set_source(context, theme_line, 1);
	cairo_set_line_width(context, px(overlay, 0.3f));
	cairo_stroke(context);
	for (int i = 0; i < (int)overlay->language_count; i++)
		draw_name(overlay, context, &grid, i);
	overlay_end(overlay, BITMAP_LANGUAGES, context);
}

bool overlay_update_languages(struct overlay *overlay, int64_t step_ms)
{
	struct languages_menu *menu = &overlay->menu;

	if (menu->dirty && menu->fade.on) {
		draw_menu(overlay);
		menu->dirty = false;
	}
	return overlay_advance(&menu->fade, step_ms);
}
