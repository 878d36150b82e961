/* Draws the help pictures and computes where the moving fingertips are on them. */
#include "ui/help_view.h"

#include <math.h>

#include "base/compiler.h"
#include "ui/icon.h"
#include "ui/translate.h"

/* Millimetres. */
#define PADDING_MM 3.0f
#define ICON_MM    14.0f
#define CELL_MM    38.0f
#define FINGER_MM  4.0f
/* In units of half an icon. */
#define TURN_REACH 0.6f
#define ZOOM_NEAR  0.26f
#define ZOOM_FAR   0.62f

enum { CELLS = 3, MOVE_MS = 1500 };

static int cells(bool has_names)
{
	return CELLS - !has_names; /* the last cell explains names */
}

/* The middle of a cell. The first cell is on the side where lines of the language begin. */
static float cell_x(const struct theme *theme, int width_px, int cell, int count)
{
	const float padding = (float)theme_px(theme, PADDING_MM);
	const float cell_px = ((float)width_px - 2 * padding) / (float)count;

	if (theme_is_right_to_left(theme))
		cell = count - 1 - cell;
	return padding + cell_px * ((float)cell + 0.5f);
}

static float icon_y(const struct theme *theme)
{
	return 1.5f * (float)theme_px(theme, PADDING_MM) + (float)theme_px(theme, ICON_MM) / 2;
}

static void draw(struct help_view *view, const struct screen *screen, bool has_names)
{
	static const struct {
		enum icon icon;
		const char *text;
	} lines[CELLS] = {
		/* Translators: three captions of pictures that show what fingers do. */
		{ ICON_TURN, N_("Drag to rotate") },
		{ ICON_ZOOM, N_("Pinch to zoom") },
		{ ICON_TAP, N_("Tap a name to learn more") },
	};
	const struct theme *theme = screen->theme;
	const int most_width_px = screen->scene.width_px - 2 * screen_px(screen, THEME_GAP_MM);
	const int count = cells(has_names);
	int padding = theme_px(theme, PADDING_MM), icon_px = theme_px(theme, ICON_MM);
	int cell_px = theme_text_px(theme, CELL_MM), text_px = 0;
	int width_px, height_px;
	PangoLayout *layouts[CELLS];
	cairo_t *context;

	if (cell_px * count + 2 * padding > most_width_px)
		cell_px = (most_width_px - 2 * padding) / count;
	for (int i = 0; i < count; i++) {
		layouts[i] =
			theme_layout(theme, TEXT_CAPTION, translate(theme->language, lines[i].text),
				     cell_px - padding > 1 ? cell_px - padding : 1);
		pango_layout_set_alignment(layouts[i], PANGO_ALIGN_CENTER);
		pango_layout_get_pixel_size(layouts[i], NULL, &height_px);
		if (height_px > text_px)
			text_px = height_px;
	}
	width_px = cell_px * count + 2 * padding;
	height_px = icon_px + text_px + 4 * padding;
	context = sprite_begin(&view->sprite, width_px, height_px);
	if (context) {
		theme_rounded(context, 0, 0, width_px, height_px, theme_px(theme, THEME_RADIUS_MM));
		theme_set_source(context, theme_night, THEME_CHIP_ALPHA);
		cairo_fill(context);
		theme_set_source(context, theme_night_text, 1);
		for (int i = 0; i < count; i++) {
			const double x = (double)cell_x(theme, width_px, i, count);

			icon_draw(context, lines[i].icon, x, (double)icon_y(theme), icon_px);
			cairo_move_to(context, x - (cell_px - padding) / 2.0,
				      2.5 * padding + icon_px);
			pango_cairo_show_layout(context, layouts[i]);
		}
		sprite_end(&view->sprite, context);
	}
	for (int i = 0; i < count; i++)
		g_object_unref(layouts[i]);
}

static void draw_finger(struct sprite *sprite, const struct theme *theme)
{
	const int side_px = theme_px(theme, FINGER_MM);
	const double middle = side_px / 2.0, turn = 4 * acos(0.0);
	cairo_t *context = sprite_begin(sprite, side_px, side_px);

	if (!context)
		return;
	cairo_arc(context, middle, middle, middle, 0, turn);
	theme_set_source(context, theme_night, 1); /* separates it from the path it moves on */
	cairo_fill(context);
	cairo_arc(context, middle, middle, middle * 0.78, 0, turn);
	theme_set_source(context, theme_night_text, 1);
	cairo_fill(context);
	sprite_end(sprite, context);
}

/* One finger turns, then two zoom, and so on. They start and end at rest. */
void help_view_fingers(const struct theme *theme, int width_px, bool has_names, int64_t shown_ms,
		       float middles_px[HELP_FINGERS][2])
{
	const float full_turn = 4 * acosf(0);
	const float phase = full_turn * (float)(shown_ms % MOVE_MS) / MOVE_MS;
	const bool moves = shown_ms < HELP_MOVES_MS, zooms = shown_ms / MOVE_MS % 2 == 1;
	const float half = (float)theme_px(theme, ICON_MM) / 2, y = icon_y(theme);
	/* A squared sine has zero speed at both ends. */
	const float there = moves ? (1 - cosf(phase)) / 2 : 0;
	const float side = zooms ? 0 : TURN_REACH * sinf(phase) * (moves ? sqrtf(there) : 0);
	const float apart = ZOOM_NEAR + (zooms ? there * (ZOOM_FAR - ZOOM_NEAR) : 0);
	const float turn_x = cell_x(theme, width_px, 0, cells(has_names));
	const float zoom_x = cell_x(theme, width_px, 1, cells(has_names));

	middles_px[0][0] = turn_x + side * half;
	middles_px[0][1] = y;
	for (int i = 0; i < 2; i++) {
		middles_px[1 + i][0] = zoom_x + (i ? apart : -apart) * half;
		middles_px[1 + i][1] = y + (i ? -apart : apart) * half;
	}
}

/* ---- state ---- */

void help_view_init(struct help_view *view, const struct theme *theme, uint32_t *next_id)
{
	*view = (struct help_view){ .dirty = true, .fade = { .on = true } };
	sprites_init(&view->sprite, 1, next_id);
	sprites_init(&view->finger, 1, next_id);
	draw_finger(&view->finger, theme);
}

void help_view_finish(struct help_view *view)
{
	sprites_finish(&view->sprite, 1);
	sprites_finish(&view->finger, 1);
}

bool help_view_show(struct help_view *view, bool on)
{
	if (view->fade.on == on)
		return false;
	view->fade.on = on;
	view->dirty |= on;
	view->shown_ms = on ? 0 : view->shown_ms;
	return true;
}

struct rect help_view_rect(const struct help_view *view, const struct screen *screen)
{
	return screen_above_floor(screen, view->sprite.bitmap.width_px,
				  view->sprite.bitmap.height_px);
}

/* ---- a frame ---- */

bool help_view_update(struct help_view *view, const struct screen *screen, bool has_names,
		      int64_t step_ms)
{
	bool moving;

	if (view->dirty)
		draw(view, screen, has_names);
	view->dirty = false;
	moving = fade_advance(&view->fade, step_ms);
	if (view->fade.on && view->shown_ms < HELP_MOVES_MS) {
		view->shown_ms += step_ms;
		moving = true;
	}
	return moving;
}

void help_view_layers(const struct help_view *view, const struct screen *screen, bool has_names,
		      struct layers *layers)
{
	const struct bitmap *finger = &view->finger.bitmap;
	const struct rect rect = help_view_rect(view, screen);
	const float alpha = fade_eased(&view->fade);
	float middles_px[HELP_FINGERS][2];

	layers_add_at(layers, &view->sprite, alpha, (float)rect.x_px, (float)rect.y_px);
	help_view_fingers(screen->theme, rect.width_px, has_names, view->shown_ms, middles_px);
	for (int i = 0; i < HELP_FINGERS; i++)
		layers_add_at(layers, &view->finger, alpha,
			      (float)rect.x_px + middles_px[i][0] - (float)finger->width_px / 2,
			      (float)rect.y_px + middles_px[i][1] - (float)finger->height_px / 2);
}
