/* Draws the help pictures and computes where the moving fingertips are on them. */
#include "ui/hint.h"

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

int hint_draw(struct bitmap *out, const struct theme *theme, int most_width_px, bool has_names)
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
	const int count = cells(has_names);
	int padding = theme_px(theme, PADDING_MM), icon_px = theme_px(theme, ICON_MM);
	int cell_px = theme_text_px(theme, CELL_MM), text_px = 0;
	PangoLayout *layouts[CELLS];
	int rc;

	if (cell_px * count + 2 * padding > most_width_px)
		cell_px = (most_width_px - 2 * padding) / count;
	for (int i = 0; i < count; i++) {
		int height_px;

		layouts[i] =
			theme_layout(theme, TEXT_CAPTION, translate(theme->language, lines[i].text),
				     cell_px - padding > 1 ? cell_px - padding : 1);
		pango_layout_set_alignment(layouts[i], PANGO_ALIGN_CENTER);
		pango_layout_get_pixel_size(layouts[i], NULL, &height_px);
		if (height_px > text_px)
			text_px = height_px;
	}
	rc = bitmap_init(out, cell_px * count + 2 * padding, icon_px + text_px + 4 * padding);
	if (rc == 0) {
		cairo_t *context = bitmap_begin(out);

		theme_rounded(context, 0, 0, out->width_px, out->height_px,
			      theme_px(theme, THEME_RADIUS_MM));
		theme_set_source(context, theme_night, THEME_CHIP_ALPHA);
		cairo_fill(context);
		theme_set_source(context, theme_night_text, 1);
		for (int i = 0; i < count; i++) {
			const double x = (double)cell_x(theme, out->width_px, i, count);

			icon_draw(context, lines[i].icon, x, (double)icon_y(theme), icon_px);
			cairo_move_to(context, x - (cell_px - padding) / 2.0,
				      2.5 * padding + icon_px);
			pango_cairo_show_layout(context, layouts[i]);
		}
		bitmap_end(out, context);
	}
	for (int i = 0; i < count; i++)
		g_object_unref(layouts[i]);
	return rc;
}

int hint_draw_finger(struct bitmap *out, const struct theme *theme)
{
	const int side_px = theme_px(theme, FINGER_MM);
	const double middle = side_px / 2.0, turn = 4 * acos(0.0);
	cairo_t *context;
	int rc = bitmap_init(out, side_px, side_px);

	if (rc < 0)
		return rc;
	context = bitmap_begin(out);
	cairo_arc(context, middle, middle, middle, 0, turn);
	theme_set_source(context, theme_night, 1); /* separates it from the path it moves on */
	cairo_fill(context);
	cairo_arc(context, middle, middle, middle * 0.78, 0, turn);
	theme_set_source(context, theme_night_text, 1);
	cairo_fill(context);
	bitmap_end(out, context);
	return 0;
}

/* One finger turns, then two zoom, and so on. They start and end at rest. */
void hint_fingers(const struct theme *theme, int width_px, bool has_names, int64_t shown_ms,
		  float middles_px[HINT_FINGERS][2])
{
	const float full_turn = 4 * acosf(0);
	const float phase = full_turn * (float)(shown_ms % MOVE_MS) / MOVE_MS;
	const bool moves = shown_ms < HINT_MOVES_MS, zooms = shown_ms / MOVE_MS % 2 == 1;
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
