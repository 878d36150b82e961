/* Guided tours: the panel below the model while a tour runs, and the menu of tours. Both stand
 * where a card would, so only one of the three is visible at a time. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ui/icon.h"
#include "ui/overlay_state.h"
#include "ui/translate.h"

#define WIDTH_MM   150.0f
#define PADDING_MM 3.0f
#define DOTS_MM    5.0f /* height of the line with the stops' dots */
#define DOT_MM     1.1f
#define ROW_MM     14.0f /* row of the menu */
#define ICON_MM    3.2f

enum { LINES_MAX = 4 };

static int px(const struct overlay *overlay, float mm)
{
	return theme_px(&overlay->theme, mm);
}

/* ---- state ---- */

int overlay_tours(struct overlay *overlay, const struct overlay_tour *tours, uint32_t count)
{
	struct tour_entry entries[OVERLAY_TOURS_MAX] = { 0 };
	int rc = count > OVERLAY_TOURS_MAX ? -1 : 0;

	for (uint32_t i = 0; rc == 0 && i < count; i++) {
		entries[i].title = strdup(tours[i].title);
		entries[i].caption = strdup(tours[i].caption);
		entries[i].thumbnail = strdup(tours[i].thumbnail);
		if (!entries[i].title || !entries[i].caption || !entries[i].thumbnail)
			rc = -1;
	}
	overlay_drop_tours(rc == 0 ? overlay->tours.entries : entries);
	if (rc < 0)
		return rc;
	memcpy(overlay->tours.entries, entries, sizeof(entries));
	overlay->tours.dirty = overlay->tour.dirty = true;
	if (overlay->tours.count == count)
		return 0;
	overlay->tours.count = count;
	overlay->tours.fade = overlay->tour.fade = (struct fade){ 0 };
	overlay->tour.on = false;
	overlay_lay_out_chrome(overlay);
	return 0;
}

void overlay_drop_tours(struct tour_entry *entries)
{
	for (uint32_t i = 0; i < OVERLAY_TOURS_MAX; i++) {
		free(entries[i].title);
		free(entries[i].caption);
		free(entries[i].thumbnail);
	}
}

void overlay_show_tours(struct overlay *overlay, bool on)
{
	on = on && overlay->tours.count > 0;
	if (on == overlay->tours.fade.on)
		return;
	overlay->tours.fade.on = on;
	overlay->tours.dirty |= on;
	overlay->chrome_dirty = overlay->callouts_dirty = true;
	if (!on)
		return;
	overlay_close_page(overlay);
	overlay_show_search(overlay, false);
	overlay_show_card(overlay, -1);
	overlay_show_help(overlay, false);
}

bool overlay_choosing(const struct overlay *overlay)
{
	return overlay->tours.fade.on;
}

void overlay_show_tour(struct overlay *overlay, const struct overlay_tour_state *state)
{
	struct tour_panel *panel = &overlay->tour;

	overlay->callouts_dirty |= panel->on != (state != NULL);
	overlay->chrome_dirty |= panel->on != (state != NULL);
	panel->on = state != NULL;
	if (!state)
		return;
	if (strcmp(panel->caption, state->caption) != 0 || panel->tour != state->tour) {
		panel->fade.alpha = 0; /* it has another size too: fade in again, do not jump */
		overlay->callouts_dirty = true;
	}
	panel->dirty |= panel->fade.alpha == 0 || panel->stop != state->stop ||
			panel->paused != state->paused;
	panel->tour = state->tour;
	panel->stop = state->stop;
	panel->stop_count = state->stop_count;
	panel->paused = state->paused;
	snprintf(panel->caption, sizeof(panel->caption), "%s", state->caption);
}

bool overlay_tour_shows(const struct overlay *overlay)
{
	return overlay->tour.on && overlay->card_part < 0 && overlay->page_part < 0 &&
	       !overlay->search.fade.on && !overlay->help.on && !overlay->tours.fade.on;
}

void overlay_picture_of_tours(struct overlay *overlay, const char *name)
{
	for (uint32_t i = 0; i < overlay->tours.count; i++)
		if (strcmp(overlay->tours.entries[i].thumbnail, name) == 0)
			overlay->tours.dirty = true;
}

/* ---- layout of the panel ---- */

static int most_width(const struct overlay *overlay)
{
	int most_px = overlay_scene_rect(overlay).width_px - 2 * px(overlay, THEME_GAP_MM);
	int width_px = theme_text_px(&overlay->theme, WIDTH_MM);

	return width_px < most_px ? width_px : most_px;
}

/* The height available above the bar; in reach mode only its low part. */
static int most_height(const struct overlay *overlay)
{
	int gap_px = px(overlay, THEME_GAP_MM);
	int floor_px = overlay_chrome_rect(overlay).y_px - gap_px;

	return floor_px -
	       (overlay_reach_top(overlay) > gap_px ? overlay_reach_top(overlay) + gap_px : gap_px);
}

static int head_height(const struct overlay *overlay)
{
	return theme_text_px(&overlay->theme, THEME_TARGET_MM) + px(overlay, THEME_GAP_MM);
}

/* Lays out the caption with as many lines as fit. The caller unrefs the layout. */
static PangoLayout *lay_out_caption(const struct overlay *overlay, int *height_px)
{
	int room_px = most_width(overlay) - 2 * px(overlay, PADDING_MM);
	int most_px = most_height(overlay) - head_height(overlay) - px(overlay, DOTS_MM) -
		      px(overlay, PADDING_MM);

	for (int lines = LINES_MAX;; lines--) {
		PangoLayout *layout =
			theme_layout(&overlay->theme, TEXT_CAPTION, overlay->tour.caption, room_px);

		theme_limit_lines(layout, room_px > 1 ? room_px : 1, lines);
		pango_layout_get_pixel_size(layout, NULL, height_px);
		if (*height_px <= most_px || lines == 1)
			return layout;
		g_object_unref(layout);
	}
}

struct rect overlay_tour_rect(const struct overlay *overlay)
{
	const struct bitmap *bitmap = &overlay->sprites[BITMAP_TOUR].bitmap;

	return overlay_above_floor(overlay, bitmap->width_px, bitmap->height_px);
}

static PangoLayout *lay_out_button(const struct overlay *overlay, int *width_px)
{
	PangoLayout *layout = theme_layout(
		&overlay->theme, TEXT_BUTTON,
		overlay->tour.paused ? translate(overlay->theme.language, "Continue") : "", -1);
	int label_px;

	pango_layout_get_pixel_size(layout, &label_px, NULL);
	*width_px = overlay->tour.paused
			    ? label_px + px(overlay, ICON_MM) + 3 * px(overlay, PADDING_MM)
			    : 0;
	if (*width_px < px(overlay, 2 * THEME_TARGET_MM))
		*width_px = px(overlay, 2 * THEME_TARGET_MM);
	return layout;
}

/* The close control takes the whole end of the head. */
static int cross_width(const struct overlay *overlay)
{
	return px(overlay, THEME_TARGET_MM) + px(overlay, THEME_GAP_MM);
}

/* ---- taps ---- */

struct overlay_action overlay_tour_tap(const struct overlay *overlay, float x_px, float y_px)
{
	struct overlay_action action = { .kind = OVERLAY_SWALLOWED, .part = -1 };
	struct rect panel = overlay_tour_rect(overlay);
	int button_px, right_px = panel.x_px + panel.width_px - cross_width(overlay);
	bool is_head = y_px < (float)(panel.y_px + head_height(overlay));

	if (is_head && x_px >= (float)right_px) {
		action.kind = OVERLAY_TOUR_CLOSE;
		return action;
	}
	g_object_unref(lay_out_button(overlay, &button_px));
	/* A paused tour goes on by a tap anywhere on the panel. */
	if (overlay->tour.paused || (is_head && x_px >= (float)(right_px - button_px)))
		action.kind = OVERLAY_TOUR_PAUSE;
	return action;
}

/* ---- the panel's bitmap ---- */

/* Draws one dot per stop. The current or next stop is larger; stops up to it are filled. */
static void draw_dots(struct overlay *overlay, cairo_t *context, int width_px, int y_px)
{
	const struct tour_panel *panel = &overlay->tour;
	double radius = px(overlay, DOT_MM), turn = 4 * acos(0.0);
	double step = 4 * radius;

	if (step * panel->stop_count > width_px)
		step = (double)width_px / panel->stop_count;
	for (int i = 0; i < panel->stop_count; i++) {
		bool is_here = i == panel->stop;
		double along = radius + step * i;
		double x = px(overlay, PADDING_MM) +
			   (theme_is_right_to_left(&overlay->theme) ? width_px - along : along);

		cairo_new_path(context);
		cairo_arc(context, x, y_px, is_here ? radius * 1.25 : radius * 0.8, 0, turn);
		theme_set_source(context, theme_night_text, i <= panel->stop ? 1 : THEME_DIM_ALPHA);
		if (i <= panel->stop) {
			cairo_fill(context);
		} else {
			cairo_set_line_width(context, radius * 0.4);
			cairo_stroke(context);
		}
	}
}

static void draw_button(struct overlay *overlay, cairo_t *context, int right_px)
{
	const bool from_right = theme_is_right_to_left(&overlay->theme);
	int width_px, words_px, text_px, height_px = px(overlay, THEME_TARGET_MM);
	PangoLayout *layout = lay_out_button(overlay, &width_px);
	double y = head_height(overlay) / 2.0, x = right_px - width_px;
	const double from_side = px(overlay, PADDING_MM) + px(overlay, ICON_MM) / 2.0;

	if (overlay->tour.paused) {
		theme_rounded(context, x, y - height_px / 2.0, width_px, height_px,
			      height_px / 2.0);
		theme_set_source(context, theme_accent, 1);
		cairo_fill(context);
	}
	theme_set_source(context, overlay->tour.paused ? theme_paper : theme_night_text, 1);
	pango_layout_get_pixel_size(layout, &words_px, &text_px);
	cairo_move_to(context,
		      from_right ? right_px - px(overlay, PADDING_MM) - words_px
				 : x + px(overlay, PADDING_MM),
		      y - text_px / 2.0);
	pango_cairo_show_layout(context, layout);
	if (overlay->tour.paused)
		icon_draw(context, from_right ? ICON_BACK : ICON_FORWARD,
			  from_right ? x + from_side : right_px - from_side, y,
			  px(overlay, ICON_MM));
	else
		icon_draw(context, ICON_PAUSE, right_px - width_px / 2.0, y,
			  px(overlay, 1.4f * ICON_MM));
	g_object_unref(layout);
}

static void draw_panel(struct overlay *overlay)
{
	int width_px = most_width(overlay), padding = px(overlay, PADDING_MM), height_px, text_px;
	int head_px = head_height(overlay), right_px = width_px - cross_width(overlay), button_px;
	PangoLayout *caption = lay_out_caption(overlay, &height_px), *title;
	cairo_t *context;

	height_px += head_px + px(overlay, DOTS_MM) + padding;
	context = overlay_begin(overlay, BITMAP_TOUR, width_px, height_px);
	if (context) {
		theme_rounded(context, 0, 0, width_px, height_px, px(overlay, THEME_RADIUS_MM));
		theme_set_source(context, theme_night, THEME_CHIP_ALPHA);
		cairo_fill(context);
		g_object_unref(lay_out_button(overlay, &button_px));
		title = theme_layout(&overlay->theme, TEXT_BUTTON,
				     overlay->tours.entries[overlay->tour.tour].title, -1);
		button_px = right_px - button_px - 2 * padding;
		theme_limit_lines(title, button_px > 1 ? button_px : 1, 1);
		pango_layout_get_pixel_size(title, NULL, &text_px);
		theme_set_source(context, theme_night_text, 1);
		cairo_move_to(context, padding, (head_px - text_px) / 2.0);
		pango_cairo_show_layout(context, title);
		g_object_unref(title);
		draw_button(overlay, context, right_px);
		theme_set_source(context, theme_night_text, 1);
		icon_draw(context, ICON_CLOSE, right_px + cross_width(overlay) / 2.0, head_px / 2.0,
			  px(overlay, ICON_MM));
		cairo_move_to(context, padding, head_px);
		pango_cairo_show_layout(context, caption);
		draw_dots(overlay, context, width_px - 2 * padding,
			  height_px - padding / 2 - px(overlay, DOTS_MM) / 2);
		overlay_end(overlay, BITMAP_TOUR, context);
	}
	g_object_unref(caption);
}

/* ---- the menu ---- */

struct menu {
	struct rect all;
	int head_px, row_px, columns;
};

/* Rows stand below each other, or in two columns if there are too many. */
static struct menu lay_out_menu(const struct overlay *overlay)
{
	int count = (int)overlay->tours.count, padding = px(overlay, THEME_GAP_MM), rows;
	struct menu menu = { .head_px = head_height(overlay),
			     .row_px = theme_text_px(&overlay->theme, ROW_MM),
			     .columns = 1 };
	int most_px = most_height(overlay) - menu.head_px - padding;

	if (count * menu.row_px > most_px)
		menu.columns = 2;
	rows = (count + menu.columns - 1) / menu.columns;
	if (rows * menu.row_px > most_px && rows > 0)
		menu.row_px = most_px / rows;
	if (menu.row_px < px(overlay, THEME_TARGET_MM))
		menu.row_px = px(overlay, THEME_TARGET_MM);
	menu.all = overlay_above_floor(overlay, most_width(overlay),
				       menu.head_px + rows * menu.row_px + padding);
	return menu;
}

struct rect overlay_menu_rect(const struct overlay *overlay)
{
	return lay_out_menu(overlay).all;
}

struct overlay_action overlay_menu_tap(const struct overlay *overlay, float x_px, float y_px)
{
	struct overlay_action action = { .kind = OVERLAY_SWALLOWED, .part = -1 };
	struct menu menu = lay_out_menu(overlay);
	int x = (int)x_px - menu.all.x_px, y = (int)y_px - menu.all.y_px - menu.head_px;
	int index = y / menu.row_px * menu.columns + x * menu.columns / menu.all.width_px;

	if (y < 0) {
		if (x >= menu.all.width_px - cross_width(overlay))
			action.kind = OVERLAY_TOURS;
		return action;
	}
	if (index >= (int)overlay->tours.count ||
	    y / menu.row_px >= ((int)overlay->tours.count + menu.columns - 1) / menu.columns)
		return action;
	action.kind = OVERLAY_TOUR;
	action.tour = index;
	return action;
}

/* Draws title and picture of a tour, and its caption if it fits. */
static void draw_entry(struct overlay *overlay, cairo_t *context, const struct tour_entry *entry,
		       struct rect at)
{
	const bool from_right = theme_is_right_to_left(&overlay->theme);
	int gap_px = px(overlay, THEME_GAP_MM), side_px = at.height_px - gap_px;
	int title_px = theme_line_px(&overlay->theme, TEXT_BUTTON, entry->title);
	int caption_px = theme_line_px(&overlay->theme, TEXT_FIGURE, entry->caption), y_px;
	struct overlay_picture found = { 0 };
	struct bitmap scaled;

	cairo_rectangle(context, at.x_px, at.y_px, at.width_px, 1);
	theme_set_source(context, theme_line, 1);
	cairo_fill(context);
	if (*entry->thumbnail && overlay->pictures.get &&
	    overlay->pictures.get(overlay->pictures.data, entry->thumbnail, &found)) {
		const int left_px = from_right ? at.x_px + at.width_px - side_px : at.x_px;

		cairo_rectangle(context, left_px, at.y_px + gap_px / 2.0, side_px, side_px);
		theme_set_source(context, theme_paper_shade, 1);
		cairo_fill(context);
		if (found.picture &&
		    bitmap_from_picture(&scaled, found.picture, side_px, side_px) == 0) {
			cairo_set_source_surface(context, scaled.surface, left_px,
						 at.y_px + gap_px / 2);
			cairo_paint(context);
			bitmap_finish(&scaled);
		}
		at.x_px += from_right ? 0 : side_px + gap_px;
		at.width_px -= side_px + gap_px;
	}
	if (!*entry->caption || title_px + caption_px > at.height_px)
		caption_px = 0;
	y_px = at.y_px + (at.height_px - title_px - caption_px) / 2;
	theme_show_line(context, &overlay->theme, TEXT_BUTTON, theme_accent, entry->title, at.x_px,
			y_px, at.width_px);
	if (caption_px > 0)
		theme_show_line(context, &overlay->theme, TEXT_FIGURE, theme_ink_soft,
				entry->caption, at.x_px, y_px + title_px, at.width_px);
}

static void draw_menu(struct overlay *overlay)
{
	struct menu menu = lay_out_menu(overlay);
	int padding = px(overlay, PADDING_MM), width_px = menu.all.width_px, cross_px, text_px;
	const char *head = translate(overlay->theme.language, "Guided tours");
	cairo_t *context = overlay_begin(overlay, BITMAP_TOURS, width_px, menu.all.height_px);

	if (!context)
		return;
	cross_px = cross_width(overlay);
	text_px = theme_line_px(&overlay->theme, TEXT_TITLE, head);
	theme_rounded(context, 0, 0, width_px, menu.all.height_px, px(overlay, THEME_RADIUS_MM));
	theme_set_source(context, theme_paper, 1);
	cairo_fill(context);
	theme_show_line(context, &overlay->theme, TEXT_TITLE, theme_ink, head, padding,
			(menu.head_px - text_px) / 2, width_px - cross_px - padding);
	theme_set_source(context, theme_ink_soft, 1);
	icon_draw(context, ICON_CLOSE, width_px - cross_px / 2.0, menu.head_px / 2.0,
		  px(overlay, ICON_MM));
	for (int i = 0; i < (int)overlay->tours.count; i++)
		draw_entry(overlay, context, &overlay->tours.entries[i],
			   (struct rect){ width_px * (i % menu.columns) / menu.columns + padding,
					  menu.head_px + i / menu.columns * menu.row_px,
					  width_px / menu.columns - 2 * padding, menu.row_px });
	overlay_end(overlay, BITMAP_TOURS, context);
}

/* ---- a frame ---- */

bool overlay_update_tours(struct overlay *overlay, int64_t step_ms)
{
	bool was_on = overlay->tour.fade.on, moving;

	overlay->tour.fade.on = overlay_tour_shows(overlay);
	if (overlay->tour.fade.on != was_on)
		overlay->callouts_dirty = true;
	if (overlay->tour.dirty && overlay->tour.fade.on) {
		draw_panel(overlay);
		overlay->tour.dirty = false;
	}
	if (overlay->tours.dirty && overlay->tours.fade.on) {
		draw_menu(overlay);
		overlay->tours.dirty = false;
	}
	moving = fade_advance(&overlay->tour.fade, step_ms);
	return fade_advance(&overlay->tours.fade, step_ms) || moving;
}
