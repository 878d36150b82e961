/* Lists the tours in one or two columns, with their pictures. */
#include "ui/tours_view.h"

#include <stdlib.h>
#include <string.h>

#include "ui/icon.h"
#include "ui/tour_box.h"
#include "ui/translate.h"

#define ROW_MM 14.0f

void tours_view_init(struct tours_view *view, uint32_t *next_id)
{
	*view = (struct tours_view){ 0 };
	sprites_init(&view->sprite, 1, next_id);
}

/* ---- state ---- */

static void free_tours(struct overlay_tour *tours)
{
	for (uint32_t i = 0; i < OVERLAY_TOURS_MAX; i++) {
		free((char *)tours[i].title);
		free((char *)tours[i].caption);
		free((char *)tours[i].thumbnail);
	}
}

void tours_view_finish(struct tours_view *view)
{
	free_tours(view->list);
	sprites_finish(&view->sprite, 1);
}

int tours_view_set(struct tours_view *view, const struct overlay_tour *tours, uint32_t count)
{
	struct overlay_tour list[OVERLAY_TOURS_MAX] = { 0 };
	int rc = count > OVERLAY_TOURS_MAX ? -1 : 0;

	for (uint32_t i = 0; rc == 0 && i < count; i++) {
		list[i].title = strdup(tours[i].title);
		list[i].caption = strdup(tours[i].caption);
		list[i].thumbnail = strdup(tours[i].thumbnail);
		if (!list[i].title || !list[i].caption || !list[i].thumbnail)
			rc = -1;
	}
	free_tours(rc == 0 ? view->list : list);
	if (rc < 0)
		return rc;
	memcpy(view->list, list, sizeof(list));
	if (view->count != count)
		view->fade = (struct fade){ 0 };
	view->count = count;
	view->dirty = true;
	return 0;
}

bool tours_view_show(struct tours_view *view, bool on)
{
	on = on && view->count > 0;
	if (on == view->fade.on)
		return false;
	view->fade.on = on;
	view->dirty |= on;
	return true;
}

void tours_view_picture_arrived(struct tours_view *view, const char *name)
{
	for (uint32_t i = 0; i < view->count; i++)
		if (strcmp(view->list[i].thumbnail, name) == 0)
			view->dirty = true;
}

/* ---- layout ---- */

struct menu {
	struct rect all;
	int head_px, row_px, columns;
};

/* Rows stand below each other, or in two columns if there are too many. */
static struct menu lay_out(const struct tours_view *view, const struct screen *screen)
{
	int count = (int)view->count, padding = screen_px(screen, THEME_GAP_MM), rows;
	struct menu menu = { .head_px = tour_box_head(screen),
			     .row_px = screen_text_px(screen, ROW_MM),
			     .columns = 1 };
	int most_px = tour_box_most_height(screen) - menu.head_px - padding;

	if (count * menu.row_px > most_px)
		menu.columns = 2;
	rows = (count + menu.columns - 1) / menu.columns;
	if (rows * menu.row_px > most_px && rows > 0)
		menu.row_px = most_px / rows;
	if (menu.row_px < screen_px(screen, THEME_TARGET_MM))
		menu.row_px = screen_px(screen, THEME_TARGET_MM);
	menu.all = screen_above_floor(screen, tour_box_width(screen),
				      menu.head_px + rows * menu.row_px + padding);
	return menu;
}

struct rect tours_view_rect(const struct tours_view *view, const struct screen *screen)
{
	return lay_out(view, screen).all;
}

struct overlay_action tours_view_tap(const struct tours_view *view, const struct screen *screen,
				     float x_px, float y_px)
{
	struct overlay_action action = { .kind = OVERLAY_SWALLOWED, .part = -1 };
	struct menu menu = lay_out(view, screen);
	int x = (int)x_px - menu.all.x_px, y = (int)y_px - menu.all.y_px - menu.head_px;
	int index = y / menu.row_px * menu.columns + x * menu.columns / menu.all.width_px;

	if (y < 0) {
		if (x >= menu.all.width_px - tour_box_cross(screen))
			action.kind = OVERLAY_TOURS;
		return action;
	}
	if (index >= (int)view->count ||
	    y / menu.row_px >= ((int)view->count + menu.columns - 1) / menu.columns)
		return action;
	action.kind = OVERLAY_TOUR;
	action.tour = index;
	return action;
}

/* ---- drawing ---- */

/* Draws title and picture of a tour, and its caption if it fits. */
static void draw_tour(cairo_t *context, const struct screen *screen,
		      const struct picture_source *pictures, const struct overlay_tour *tour,
		      struct rect at)
{
	const struct theme *theme = screen->theme;
	const bool from_right = theme_is_right_to_left(theme);
	int gap_px = screen_px(screen, THEME_GAP_MM), side_px = at.height_px - gap_px;
	int title_px = theme_line_px(theme, TEXT_BUTTON, tour->title);
	int caption_px = theme_line_px(theme, TEXT_FIGURE, tour->caption), y_px;
	struct found_picture found = { 0 };
	struct bitmap scaled;

	cairo_rectangle(context, at.x_px, at.y_px, at.width_px, 1);
	theme_set_source(context, theme_line, 1);
	cairo_fill(context);
	if (*tour->thumbnail && pictures->get &&
	    pictures->get(pictures->data, tour->thumbnail, &found)) {
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
	if (!*tour->caption || title_px + caption_px > at.height_px)
		caption_px = 0;
	y_px = at.y_px + (at.height_px - title_px - caption_px) / 2;
	theme_show_line(context, theme, TEXT_BUTTON, theme_accent, tour->title, at.x_px, y_px,
			at.width_px);
	if (caption_px > 0)
		theme_show_line(context, theme, TEXT_FIGURE, theme_ink_soft, tour->caption, at.x_px,
				y_px + title_px, at.width_px);
}

static void draw(struct tours_view *view, const struct screen *screen,
		 const struct picture_source *pictures)
{
	const struct theme *theme = screen->theme;
	struct menu menu = lay_out(view, screen);
	int padding = screen_px(screen, TOUR_BOX_PADDING_MM), width_px = menu.all.width_px;
	const char *head = translate(theme->language, "Guided tours");
	cairo_t *context = sprite_begin(&view->sprite, width_px, menu.all.height_px);
	int cross_px, text_px;

	if (!context)
		return;
	cross_px = tour_box_cross(screen);
	text_px = theme_line_px(theme, TEXT_TITLE, head);
	theme_rounded(context, 0, 0, width_px, menu.all.height_px,
		      screen_px(screen, THEME_RADIUS_MM));
	theme_set_source(context, theme_paper, 1);
	cairo_fill(context);
	theme_show_line(context, theme, TEXT_TITLE, theme_ink, head, padding,
			(menu.head_px - text_px) / 2, width_px - cross_px - padding);
	theme_set_source(context, theme_ink_soft, 1);
	icon_draw(context, ICON_CLOSE, width_px - cross_px / 2.0, menu.head_px / 2.0,
		  screen_px(screen, TOUR_BOX_ICON_MM));
	for (int i = 0; i < (int)view->count; i++)
		draw_tour(context, screen, pictures, &view->list[i],
			  (struct rect){ width_px * (i % menu.columns) / menu.columns + padding,
					 menu.head_px + i / menu.columns * menu.row_px,
					 width_px / menu.columns - 2 * padding, menu.row_px });
	sprite_end(&view->sprite, context);
}

/* ---- a frame ---- */

bool tours_view_update(struct tours_view *view, const struct screen *screen,
		       const struct picture_source *pictures, int64_t step_ms)
{
	if (view->dirty && view->fade.on) {
		draw(view, screen, pictures);
		view->dirty = false;
	}
	return fade_advance(&view->fade, step_ms);
}

void tours_view_layers(const struct tours_view *view, const struct screen *screen,
		       struct layers *layers)
{
	const struct rect rect = tours_view_rect(view, screen);

	layers_add_at(layers, &view->sprite, fade_eased(&view->fade), (float)rect.x_px,
		      (float)rect.y_px);
}
