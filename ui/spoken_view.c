/* Lays out the strip. The words change every few seconds, and the bar all the time, so each has a
 * sprite of its own. */
#include "ui/spoken_view.h"

#include <stdio.h>
#include <string.h>

#define PADDING_MM 3.0f
#define BAR_MM     0.8f

enum { LINES_MAX = 3 };

void spoken_view_init(struct spoken_view *view, uint32_t *next_id)
{
	*view = (struct spoken_view){ 0 };
	sprites_init(&view->box, 1, next_id);
	sprites_init(&view->bar, 1, next_id);
	sprite_fill(&view->bar, theme_accent);
}

void spoken_view_finish(struct spoken_view *view)
{
	sprites_finish(&view->box, 1);
	sprites_finish(&view->bar, 1);
}

void spoken_view_set(struct spoken_view *view, const struct overlay_spoken *spoken)
{
	view->fade.on = spoken != NULL;
	if (!spoken)
		return;
	view->share = spoken->share;
	if (strcmp(view->words, spoken->words) == 0)
		return;
	snprintf(view->words, sizeof(view->words), "%s", spoken->words);
	view->dirty = true;
}

static int width_of(const struct screen *screen, struct rect window)
{
	const int width_px = window.width_px - 2 * screen_px(screen, THEME_GAP_MM);

	return width_px > 1 ? width_px : 1;
}

static void draw(struct spoken_view *view, const struct screen *screen, int width_px)
{
	const int padding_px = screen_px(screen, PADDING_MM);
	const int room_px = width_px > 2 * padding_px ? width_px - 2 * padding_px : 1;
	const bool has_words = view->words[0] != '\0';
	PangoLayout *layout =
		theme_layout(screen->theme, TEXT_CAPTION, has_words ? view->words : "", room_px);
	int text_px = 0, height_px;
	cairo_t *context;

	theme_limit_lines(layout, room_px, LINES_MAX);
	pango_layout_set_alignment(layout, PANGO_ALIGN_CENTER);
	if (has_words)
		pango_layout_get_pixel_size(layout, NULL, &text_px);
	height_px = text_px + (has_words ? 2 * padding_px : padding_px) + screen_px(screen, BAR_MM);
	context = sprite_begin(&view->box, width_px, height_px);
	if (context) {
		theme_rounded(context, 0, 0, width_px, height_px,
			      screen_px(screen, THEME_RADIUS_MM));
		theme_set_source(context, theme_night, THEME_CHOSEN_ALPHA);
		cairo_fill(context);
		theme_set_source(context, theme_night_text, 1);
		cairo_move_to(context, padding_px, padding_px);
		pango_cairo_show_layout(context, layout);
		sprite_end(&view->box, context);
	}
	g_object_unref(layout);
}

bool spoken_view_update(struct spoken_view *view, const struct screen *screen, struct rect window,
			int64_t step_ms)
{
	const int width_px = width_of(screen, window);

	if (view->fade.on && (view->dirty || view->box.bitmap.width_px != width_px)) {
		draw(view, screen, width_px);
		view->dirty = false;
	}
	return fade_advance(&view->fade, step_ms);
}

void spoken_view_layers(const struct spoken_view *view, const struct screen *screen,
			struct rect window, struct layers *layers)
{
	const int gap_px = screen_px(screen, THEME_GAP_MM),
		  padding_px = screen_px(screen, PADDING_MM), bar_px = screen_px(screen, BAR_MM);
	const float alpha = fade_eased(&view->fade), left = (float)(window.x_px + gap_px),
		    bottom = (float)(window.y_px + window.height_px - gap_px),
		    room = (float)(view->box.bitmap.width_px - 2 * padding_px);
	/* It grows from the side where a line of text begins. */
	const float from = theme_is_right_to_left(screen->theme) ? (1 - view->share) * room : 0;

	layers_add_at(layers, &view->box, alpha, left, bottom - (float)view->box.bitmap.height_px);
	layers_add_stretched(layers, &view->bar, alpha, left + (float)padding_px + from,
			     bottom - (float)(padding_px / 2 + bar_px), view->share * room,
			     (float)bar_px);
}
