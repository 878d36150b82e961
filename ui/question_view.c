/* Lays out and draws the question whether somebody is still there. */
#include "ui/question_view.h"

#include <stdio.h>

#include "ui/translate.h"

#define PADDING_MM 5.0f
#define GAP_MM     1.6f /* half of the space between two lines */
#define BUTTON_MM  12.0f

void question_view_init(struct question_view *view, uint32_t *next_id)
{
	*view = (struct question_view){ .dirty = true };
	sprites_init(&view->sprite, 1, next_id);
}

void question_view_finish(struct question_view *view)
{
	sprites_finish(&view->sprite, 1);
}

void question_view_ask(struct question_view *view, int seconds_left)
{
	view->fade.on = seconds_left >= 0;
	if (seconds_left < 0)
		return;
	view->dirty |= view->seconds_left != seconds_left;
	view->seconds_left = seconds_left;
}

struct rect question_view_rect(const struct question_view *view, const struct screen *screen)
{
	const struct bitmap *bitmap = &view->sprite.bitmap;

	if (screen->reach)
		return screen_above_floor(screen, bitmap->width_px, bitmap->height_px);
	return (struct rect){ (screen->width_px - bitmap->width_px) / 2,
			      (screen->height_px - bitmap->height_px) / 2, bitmap->width_px,
			      bitmap->height_px };
}

/* ---- drawing ---- */

static void draw_text(cairo_t *context, PangoLayout *layout, double x, double y)
{
	cairo_move_to(context, x, y);
	pango_cairo_show_layout(context, layout);
}

static void draw_button(cairo_t *context, PangoLayout *label, double x, double y, int width_px,
			int height_px)
{
	int label_px, text_px;

	theme_rounded(context, x, y, width_px, height_px, height_px / 2.0);
	theme_set_source(context, theme_accent, 1);
	cairo_fill(context);
	pango_layout_get_pixel_size(label, &label_px, &text_px);
	theme_set_source(context, theme_paper, 1);
	draw_text(context, label, x + (width_px - label_px) / 2.0, y + (height_px - text_px) / 2.0);
}

static void draw(struct question_view *view, const struct screen *screen)
{
	const struct theme *theme = screen->theme;
	const int most_width_px = screen->width_px - 2 * screen_px(screen, THEME_GAP_MM);
	const int padding = theme_px(theme, PADDING_MM), gap = 2 * theme_px(theme, GAP_MM);
	const int room_px = most_width_px > 3 * padding ? most_width_px - 2 * padding : padding;
	/* Translators: asked of a visitor who has touched nothing for a minute. */
	const char *texts[] = { translate(theme->language, "Are you still there?"), NULL,
				translate(theme->language, "Continue") };
	enum { QUESTION, COUNT_DOWN, BUTTON, COUNT };
	int width[COUNT], height[COUNT], button_px, wide_px, high_px;
	PangoLayout *layouts[COUNT];
	char count_down[160];
	cairo_t *context;

	snprintf(count_down, sizeof(count_down),
		 /* Translators: counts down from 15 while the question is shown. */
		 translate_plural(theme->language, "Returning to the start in %d second",
				  "Returning to the start in %d seconds",
				  (unsigned long)view->seconds_left),
		 view->seconds_left);
	texts[COUNT_DOWN] = count_down;
	for (int i = 0; i < COUNT; i++) {
		static const enum text_style styles[] = { TEXT_TITLE, TEXT_CAPTION, TEXT_BUTTON };

		layouts[i] = theme_layout(theme, styles[i], texts[i], -1);
		theme_limit_lines(layouts[i], room_px, 2);
		pango_layout_get_pixel_size(layouts[i], &width[i], &height[i]);
		/* Otherwise right-to-left text would begin at the far end of the available
		 * width. */
		pango_layout_set_width(layouts[i], width[i] * PANGO_SCALE);
	}
	button_px = width[BUTTON] + 4 * padding;
	wide_px = width[QUESTION] > width[COUNT_DOWN] ? width[QUESTION] : width[COUNT_DOWN];
	wide_px = wide_px > button_px ? wide_px : button_px;
	wide_px += 2 * padding;
	high_px = height[QUESTION] + height[COUNT_DOWN] + 3 * gap + 2 * padding +
		  theme_px(theme, BUTTON_MM);
	context = sprite_begin(&view->sprite, wide_px, high_px);
	if (context) {
		double y = padding;

		theme_rounded(context, 0, 0, wide_px, high_px, theme_px(theme, THEME_RADIUS_MM));
		theme_set_source(context, theme_paper, 1);
		cairo_fill(context);
		theme_set_source(context, theme_ink, 1);
		draw_text(context, layouts[QUESTION], (wide_px - width[QUESTION]) / 2.0, y);
		y += height[QUESTION] + gap;
		theme_set_source(context, theme_ink_soft, 1);
		draw_text(context, layouts[COUNT_DOWN], (wide_px - width[COUNT_DOWN]) / 2.0, y);
		y += height[COUNT_DOWN] + 2 * gap;
		draw_button(context, layouts[BUTTON], (wide_px - button_px) / 2.0, y, button_px,
			    theme_px(theme, BUTTON_MM));
		sprite_end(&view->sprite, context);
	}
	for (int i = 0; i < COUNT; i++)
		g_object_unref(layouts[i]);
}

/* ---- a frame ---- */

bool question_view_update(struct question_view *view, const struct screen *screen, int64_t step_ms)
{
	if (view->dirty && view->fade.on) {
		draw(view, screen);
		view->dirty = false;
	}
	return fade_advance(&view->fade, step_ms);
}

void question_view_layers(const struct question_view *view, const struct screen *screen,
			  struct layers *layers)
{
	const struct rect rect = question_view_rect(view, screen);

	layers_add_at(layers, &view->sprite, fade_eased(&view->fade), (float)rect.x_px,
		      (float)rect.y_px);
}
