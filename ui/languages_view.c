/* Lays the languages' own names out in a grid above the bar. */
#include "ui/languages_view.h"

#include "ui/endonym.h"

#define COLUMN_MM  38.0f /* width of a name; down to NARROW_MM if there are many */
#define NARROW_MM  22.0f
#define ROW_MM     11.0f
#define PADDING_MM 2.0f

enum { COLUMNS = 3 };

struct grid {
	struct rect all;
	int columns, column_px, row_px;
};

void languages_view_init(struct languages_view *view, uint32_t *next_id)
{
	*view = (struct languages_view){ 0 };
	sprites_init(&view->sprite, 1, next_id);
}

void languages_view_finish(struct languages_view *view)
{
	sprites_finish(&view->sprite, 1);
}

bool languages_view_show(struct languages_view *view, bool on)
{
	if (on == view->fade.on)
		return false;
	view->fade.on = on;
	view->dirty |= on;
	return true;
}

/* ---- layout ---- */

static int rows_of(const struct languages *languages, int columns)
{
	return ((int)languages->count + columns - 1) / columns;
}

static struct grid lay_out(const struct screen *screen, const struct languages *languages)
{
	const struct rect bar = screen->bar;
	const int gap = screen_px(screen, THEME_GAP_MM), padding = screen_px(screen, PADDING_MM);
	const int reach = screen_reach_top(screen), target = screen_px(screen, THEME_TARGET_MM);
	const int high = bar.y_px - 2 * gap - 2 * padding - reach;
	const int wide = screen->width_px - 2 * bar.x_px - 2 * padding;
	const int column_px = screen_text_px(screen, COLUMN_MM);
	struct grid grid = { .row_px = screen_text_px(screen, ROW_MM) };
	int rows;

	grid.columns = wide / column_px < COLUMNS ? wide / column_px : COLUMNS;
	if (grid.columns < 1)
		grid.columns = 1;
	/* If rows do not fit, add columns before rows shrink below a touch target. */
	while (rows_of(languages, grid.columns) * target > high &&
	       (grid.columns + 1) * screen_px(screen, NARROW_MM) <= wide)
		grid.columns++;
	rows = rows_of(languages, grid.columns);
	if (rows * grid.row_px > high)
		grid.row_px = high / rows > target ? high / rows : target;
	grid.column_px = wide / grid.columns < column_px ? wide / grid.columns : column_px;
	grid.all.width_px = grid.columns * grid.column_px + 2 * padding;
	grid.all.height_px = rows * grid.row_px + 2 * padding;
	grid.all.x_px = bar.x_px;
	grid.all.y_px = bar.y_px - gap - grid.all.height_px;
	return grid;
}

struct rect languages_view_rect(const struct screen *screen, const struct languages *languages)
{
	return lay_out(screen, languages).all;
}

/* Languages are listed row by row. */
struct overlay_action languages_view_tap(const struct screen *screen,
					 const struct languages *languages, float x_px, float y_px)
{
	const struct grid grid = lay_out(screen, languages);
	const int padding = screen_px(screen, PADDING_MM);
	struct overlay_action action = { .kind = OVERLAY_LANGUAGES, .part = -1 };
	int column, row, language;

	if (!rect_holds(grid.all, x_px, y_px))
		return action;
	column = ((int)x_px - grid.all.x_px - padding) / grid.column_px;
	row = ((int)y_px - grid.all.y_px - padding) / grid.row_px;
	column = column < grid.columns ? column : grid.columns - 1;
	language = row * grid.columns + column;
	if (language >= (int)languages->count) {
		action.kind = OVERLAY_SWALLOWED;
	} else if (language != languages->current) {
		action.kind = OVERLAY_LANGUAGE;
		action.language = languages->codes[language];
	}
	return action;
}

/* ---- drawing ---- */

static void draw_name(cairo_t *context, const struct screen *screen,
		      const struct languages *languages, const struct grid *grid, int language)
{
	const int padding = screen_px(screen, PADDING_MM);
	const int inset = screen_px(screen, THEME_GAP_MM) / 2;
	const int x = padding + language % grid->columns * grid->column_px;
	const int y = padding + language / grid->columns * grid->row_px;
	const bool is_set = language == languages->current;
	PangoLayout *layout = theme_layout(screen->theme, TEXT_BUTTON,
					   ui_endonym(languages->codes[language]), -1);
	int height_px;

	if (is_set) {
		theme_rounded(context, x + inset, y + inset, grid->column_px - 2 * inset,
			      grid->row_px - 2 * inset, screen_px(screen, THEME_RADIUS_MM));
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

static void draw(struct sprite *sprite, const struct screen *screen,
		 const struct languages *languages)
{
	const struct grid grid = lay_out(screen, languages);
	cairo_t *context = sprite_begin(sprite, grid.all.width_px, grid.all.height_px);

	if (!context)
		return;
	theme_rounded(context, 0, 0, grid.all.width_px, grid.all.height_px,
		      screen_px(screen, THEME_RADIUS_MM));
	theme_set_source(context, theme_paper, 1);
	cairo_fill_preserve(context);
	theme_set_source(context, theme_line, 1);
	cairo_set_line_width(context, screen_px(screen, 0.3f));
	cairo_stroke(context);
	for (int i = 0; i < (int)languages->count; i++)
		draw_name(context, screen, languages, &grid, i);
	sprite_end(sprite, context);
}

bool languages_view_update(struct languages_view *view, const struct screen *screen,
			   const struct languages *languages, int64_t step_ms)
{
	if (view->dirty && view->fade.on) {
		draw(&view->sprite, screen, languages);
		view->dirty = false;
	}
	return fade_advance(&view->fade, step_ms);
}

void languages_view_layers(const struct languages_view *view, const struct screen *screen,
			   const struct languages *languages, struct layers *layers)
{
	const struct rect rect = lay_out(screen, languages).all;

	layers_add_at(layers, &view->sprite, fade_eased(&view->fade), (float)rect.x_px,
		      (float)rect.y_px);
}
