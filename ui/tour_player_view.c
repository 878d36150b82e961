/* Lays out and draws the box of the tour that runs. */
#include "ui/tour_player_view.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ui/icon.h"
#include "ui/tour_box.h"
#include "ui/translate.h"

#define DOTS_MM 5.0f /* height of the line with the stops' dots */
#define DOT_MM  1.1f

enum { LINES_MAX = 4 };

void tour_player_view_init(struct tour_player_view *view, uint32_t *next_id)
{
	*view = (struct tour_player_view){ 0 };
	sprites_init(&view->sprite, 1, next_id);
}

void tour_player_view_finish(struct tour_player_view *view)
{
	free(view->caption);
	sprites_finish(&view->sprite, 1);
}

/* ---- state ---- */

static bool says(const struct tour_player_view *view, const struct overlay_tour_state *state)
{
	return view->caption && view->tour == state->tour &&
	       strcmp(view->caption, state->caption) == 0;
}

/* Without memory the words stay as they were. */
static bool keep_caption(struct tour_player_view *view, const char *caption)
{
	char *copy = strdup(caption);

	if (!copy)
		return false;
	free(view->caption);
	view->caption = copy;
	return true;
}

bool tour_player_view_set(struct tour_player_view *view, const struct overlay_tour_state *state)
{
	bool changed = view->runs != (state != NULL);

	view->runs = state != NULL;
	if (!state)
		return changed;
	if (!says(view, state) && keep_caption(view, state->caption)) {
		view->fade.alpha = 0; /* it has another size too: fade in again, do not jump */
		changed = true;
	}
	view->dirty |=
		view->fade.alpha == 0 || view->stop != state->stop || view->paused != state->paused;
	view->tour = state->tour;
	view->stop = state->stop;
	view->stop_count = state->stop_count;
	view->paused = state->paused;
	return changed;
}

void tour_player_view_drop(struct tour_player_view *view)
{
	view->runs = false;
	view->fade = (struct fade){ 0 };
}

/* ---- layout ---- */

/* Lays out the caption with as many lines as fit. The caller unrefs the layout. */
static PangoLayout *lay_out_caption(const struct tour_player_view *view,
				    const struct screen *screen, int *height_px)
{
	int padding = screen_px(screen, TOUR_BOX_PADDING_MM);
	int room_px = tour_box_width(screen) - 2 * padding;
	int most_px = tour_box_most_height(screen) - tour_box_head(screen) -
		      screen_px(screen, DOTS_MM) - padding;

	for (int lines = LINES_MAX;; lines--) {
		PangoLayout *layout = theme_layout(screen->theme, TEXT_CAPTION,
						   view->caption ? view->caption : "", room_px);

		theme_limit_lines(layout, room_px > 1 ? room_px : 1, lines);
		pango_layout_get_pixel_size(layout, NULL, height_px);
		if (*height_px <= most_px || lines == 1)
			return layout;
		g_object_unref(layout);
	}
}

struct rect tour_player_view_rect(const struct tour_player_view *view, const struct screen *screen)
{
	return screen_above_floor(screen, view->sprite.bitmap.width_px,
				  view->sprite.bitmap.height_px);
}

static PangoLayout *lay_out_button(const struct tour_player_view *view, const struct screen *screen,
				   int *width_px)
{
	const struct theme *theme = screen->theme;
	PangoLayout *layout = theme_layout(
		theme, TEXT_BUTTON, view->paused ? translate(theme->language, "Continue") : "", -1);
	int label_px;

	pango_layout_get_pixel_size(layout, &label_px, NULL);
	*width_px = view->paused ? label_px + screen_px(screen, TOUR_BOX_ICON_MM) +
					   3 * screen_px(screen, TOUR_BOX_PADDING_MM)
				 : 0;
	if (*width_px < screen_px(screen, 2 * THEME_TARGET_MM))
		*width_px = screen_px(screen, 2 * THEME_TARGET_MM);
	return layout;
}

/* ---- touch ---- */

struct overlay_action tour_player_view_tap(const struct tour_player_view *view,
					   const struct screen *screen, float x_px, float y_px)
{
	struct overlay_action action = { .kind = OVERLAY_SWALLOWED, .part = -1 };
	struct rect box = tour_player_view_rect(view, screen);
	int button_px, right_px = box.x_px + box.width_px - tour_box_cross(screen);
	bool is_head = y_px < (float)(box.y_px + tour_box_head(screen));

	if (is_head && x_px >= (float)right_px) {
		action.kind = OVERLAY_TOUR_CLOSE;
		return action;
	}
	g_object_unref(lay_out_button(view, screen, &button_px));
	/* A paused tour goes on by a tap anywhere on the box. */
	if (view->paused || (is_head && x_px >= (float)(right_px - button_px)))
		action.kind = OVERLAY_TOUR_PAUSE;
	return action;
}

/* ---- drawing ---- */

/* Draws one dot per stop. The current or next stop is larger; stops up to it are filled. */
static void draw_dots(cairo_t *context, const struct tour_player_view *view,
		      const struct screen *screen, int width_px, int y_px)
{
	double radius = screen_px(screen, DOT_MM), turn = 4 * acos(0.0);
	double step = 4 * radius;

	if (step * view->stop_count > width_px)
		step = (double)width_px / view->stop_count;
	for (int i = 0; i < view->stop_count; i++) {
		bool is_here = i == view->stop;
		double along = radius + step * i;
		double x = screen_px(screen, TOUR_BOX_PADDING_MM) +
			   (theme_is_right_to_left(screen->theme) ? width_px - along : along);

		cairo_new_path(context);
		cairo_arc(context, x, y_px, is_here ? radius * 1.25 : radius * 0.8, 0, turn);
		theme_set_source(context, theme_night_text, i <= view->stop ? 1 : THEME_DIM_ALPHA);
		if (i <= view->stop) {
			cairo_fill(context);
		} else {
			cairo_set_line_width(context, radius * 0.4);
			cairo_stroke(context);
		}
	}
}

static void draw_button(cairo_t *context, const struct tour_player_view *view,
			const struct screen *screen, int right_px)
{
	const bool from_right = theme_is_right_to_left(screen->theme);
	const int padding = screen_px(screen, TOUR_BOX_PADDING_MM);
	const int icon = screen_px(screen, TOUR_BOX_ICON_MM);
	int width_px, words_px, text_px, height_px = screen_px(screen, THEME_TARGET_MM);
	PangoLayout *layout = lay_out_button(view, screen, &width_px);
	double y = tour_box_head(screen) / 2.0, x = right_px - width_px;
	const double from_side = padding + icon / 2.0;

	if (view->paused) {
		theme_rounded(context, x, y - height_px / 2.0, width_px, height_px,
			      height_px / 2.0);
		theme_set_source(context, theme_accent, 1);
		cairo_fill(context);
	}
	theme_set_source(context, view->paused ? theme_paper : theme_night_text, 1);
	pango_layout_get_pixel_size(layout, &words_px, &text_px);
	cairo_move_to(context, from_right ? right_px - padding - words_px : x + padding,
		      y - text_px / 2.0);
	pango_cairo_show_layout(context, layout);
	if (view->paused)
		icon_draw(context, from_right ? ICON_BACK : ICON_FORWARD,
			  from_right ? x + from_side : right_px - from_side, y, icon);
	else
		icon_draw(context, ICON_PAUSE, right_px - width_px / 2.0, y,
			  screen_px(screen, 1.4f * TOUR_BOX_ICON_MM));
	g_object_unref(layout);
}

static void draw(struct tour_player_view *view, const struct screen *screen, const char *name)
{
	int width_px = tour_box_width(screen), padding = screen_px(screen, TOUR_BOX_PADDING_MM);
	int head_px = tour_box_head(screen), right_px = width_px - tour_box_cross(screen);
	int height_px, text_px, button_px;
	PangoLayout *caption = lay_out_caption(view, screen, &height_px), *title;
	cairo_t *context;

	height_px += head_px + screen_px(screen, DOTS_MM) + padding;
	context = sprite_begin(&view->sprite, width_px, height_px);
	if (context) {
		theme_rounded(context, 0, 0, width_px, height_px,
			      screen_px(screen, THEME_RADIUS_MM));
		theme_set_source(context, theme_night, THEME_CHIP_ALPHA);
		cairo_fill(context);
		g_object_unref(lay_out_button(view, screen, &button_px));
		title = theme_layout(screen->theme, TEXT_BUTTON, name, -1);
		button_px = right_px - button_px - 2 * padding;
		theme_limit_lines(title, button_px > 1 ? button_px : 1, 1);
		pango_layout_get_pixel_size(title, NULL, &text_px);
		theme_set_source(context, theme_night_text, 1);
		cairo_move_to(context, padding, (head_px - text_px) / 2.0);
		pango_cairo_show_layout(context, title);
		g_object_unref(title);
		draw_button(context, view, screen, right_px);
		theme_set_source(context, theme_night_text, 1);
		icon_draw(context, ICON_CLOSE, right_px + tour_box_cross(screen) / 2.0,
			  head_px / 2.0, screen_px(screen, TOUR_BOX_ICON_MM));
		cairo_move_to(context, padding, head_px);
		pango_cairo_show_layout(context, caption);
		draw_dots(context, view, screen, width_px - 2 * padding,
			  height_px - padding / 2 - screen_px(screen, DOTS_MM) / 2);
		sprite_end(&view->sprite, context);
	}
	g_object_unref(caption);
}

/* ---- a frame ---- */

bool tour_player_view_update(struct tour_player_view *view, const struct screen *screen, bool shows,
			     const char *title, int64_t step_ms)
{
	view->fade.on = shows;
	if (view->dirty && shows) {
		draw(view, screen, title);
		view->dirty = false;
	}
	return fade_advance(&view->fade, step_ms);
}

void tour_player_view_layers(const struct tour_player_view *view, const struct screen *screen,
			     struct layers *layers)
{
	const struct rect rect = tour_player_view_rect(view, screen);

	layers_add_at(layers, &view->sprite, fade_eased(&view->fade), (float)rect.x_px,
		      (float)rect.y_px);
}
