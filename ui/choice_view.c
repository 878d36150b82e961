/* Lays out and draws the choice of the site's states. */
#include "ui/choice_view.h"

#include <stdio.h>
#include <string.h>

#define BUTTON_MM  11.0f /* as high as the bar */
#define PADDING_MM 3.0f

void choice_view_init(struct choice_view *view, uint32_t *next_id)
{
	*view = (struct choice_view){ 0 };
	sprites_init(&view->sprite, 1, next_id);
}

void choice_view_finish(struct choice_view *view)
{
	sprites_finish(&view->sprite, 1);
}

void choice_view_set(struct choice_view *view, const char *const *titles, uint32_t count,
		     uint32_t chosen)
{
	char title[OVERLAY_CHOICE_BYTES];

	count = count < OVERLAY_CHOICES_MAX ? count : OVERLAY_CHOICES_MAX;
	view->dirty |= count != view->count || chosen != view->chosen;
	view->count = count;
	view->chosen = chosen;
	for (uint32_t i = 0; i < count; i++) {
		snprintf(title, sizeof(title), "%s", titles[i]);
		if (strcmp(title, view->titles[i]) == 0)
			continue;
		memcpy(view->titles[i], title, sizeof(title));
		view->dirty = true;
	}
}

/* ---- layout ---- */

/* The width of a button: that of its title, or less where all together are too wide. */
static int width_of(const struct choice_view *view, const struct screen *screen, uint32_t i)
{
	const int room = screen->scene.width_px - 2 * screen_px(screen, THEME_GAP_MM);
	int all = 0;

	for (uint32_t k = 0; k < view->count; k++)
		all += view->wanted_px[k];
	return all <= room ? view->wanted_px[i] : room / (int)view->count;
}

struct rect choice_view_rect(const struct choice_view *view, const struct screen *screen)
{
	const struct rect scene = screen->scene, bar = screen->bar;
	const int gap = screen_px(screen, THEME_GAP_MM);
	const int right = scene.x_px + scene.width_px - gap;
	struct rect rect = { .height_px = screen_px(screen, BUTTON_MM) };

	for (uint32_t i = 0; i < view->count; i++)
		rect.width_px += width_of(view, screen, i);
	rect.x_px = right - rect.width_px;
	rect.y_px = bar.y_px;
	if (rect.x_px < bar.x_px + bar.width_px + gap || bar.y_px >= scene.y_px + scene.height_px)
		rect.y_px = screen->reach ? bar.y_px - gap - rect.height_px : scene.y_px + gap;
	return rect;
}

bool choice_view_shows(const struct choice_view *view, const struct screen *screen,
		       const struct tools_view_obstacles *obstacles)
{
	const struct rect rect = choice_view_rect(view, screen);

	if (view->count < 2 || obstacles->all)
		return false;
	for (uint32_t i = 0; i < obstacles->count; i++)
		if (rect_meets(rect, obstacles->rects[i]))
			return false;
	return true;
}

struct overlay_action choice_view_tap(const struct choice_view *view, const struct screen *screen,
				      float x_px)
{
	struct overlay_action action = { .kind = OVERLAY_CHOICE, .part = -1 };
	float left = (float)choice_view_rect(view, screen).x_px;

	while (action.choice + 1 < view->count) {
		left += (float)width_of(view, screen, action.choice);
		if (x_px < left)
			break;
		action.choice++;
	}
	if (action.choice == view->chosen)
		action.kind = OVERLAY_SWALLOWED;
	return action;
}

/* ---- drawing ---- */

static void measure(struct choice_view *view, const struct screen *screen)
{
	const int least = screen_px(screen, BUTTON_MM), padding = screen_px(screen, PADDING_MM);

	for (uint32_t i = 0; i < view->count; i++) {
		PangoLayout *layout = theme_layout(screen->theme, TEXT_BUTTON, view->titles[i], -1);
		int width_px;

		pango_layout_get_pixel_size(layout, &width_px, NULL);
		g_object_unref(layout);
		width_px += 2 * padding;
		view->wanted_px[i] = width_px > least ? width_px : least;
	}
}

static void draw_title(cairo_t *context, const struct screen *screen, const char *title,
		       struct rect button, bool is_chosen)
{
	const int inset = screen_px(screen, 1.2f);
	PangoLayout *layout = theme_layout(screen->theme, TEXT_BUTTON, title, -1);
	int height_px;

	if (is_chosen) {
		theme_rounded(context, button.x_px + inset, inset, button.width_px - 2 * inset,
			      button.height_px - 2 * inset, screen_px(screen, THEME_RADIUS_MM));
		theme_set_source(context, theme_night_text, 1);
		cairo_fill(context);
	}
	theme_limit_lines(layout, button.width_px - 2 * inset, 1);
	pango_layout_set_alignment(layout, PANGO_ALIGN_CENTER);
	pango_layout_get_pixel_size(layout, NULL, &height_px);
	theme_set_source(context, is_chosen ? theme_night : theme_night_text, 1);
	cairo_move_to(context, button.x_px + inset, (button.height_px - height_px) / 2.0);
	pango_cairo_show_layout(context, layout);
	g_object_unref(layout);
}

static void draw(struct choice_view *view, const struct screen *screen)
{
	const struct rect rect = choice_view_rect(view, screen);
	cairo_t *context = sprite_begin(&view->sprite, rect.width_px, rect.height_px);
	struct rect button = { .height_px = rect.height_px };

	if (!context)
		return;
	theme_rounded(context, 0, 0, rect.width_px, rect.height_px,
		      screen_px(screen, THEME_RADIUS_MM));
	theme_set_source(context, theme_night, THEME_CHIP_ALPHA);
	cairo_fill(context);
	for (uint32_t i = 0; i < view->count; i++) {
		button.width_px = width_of(view, screen, i);
		draw_title(context, screen, view->titles[i], button, i == view->chosen);
		button.x_px += button.width_px;
	}
	sprite_end(&view->sprite, context);
}

bool choice_view_update(struct choice_view *view, const struct screen *screen,
			const struct tools_view_obstacles *obstacles, int64_t step_ms)
{
	if (view->count < 2 && view->fade.alpha <= 0)
		return false;
	if (view->dirty)
		measure(view, screen);
	view->fade.on = choice_view_shows(view, screen, obstacles);
	if (view->fade.on) {
		const struct rect rect = choice_view_rect(view, screen);

		if (view->dirty || rect.width_px != view->drawn.width_px)
			draw(view, screen);
		view->drawn = rect;
		view->dirty = false;
	}
	return fade_advance(&view->fade, step_ms);
}

void choice_view_layers(const struct choice_view *view, struct layers *layers)
{
	layers_add_at(layers, &view->sprite, fade_eased(&view->fade), (float)view->drawn.x_px,
		      (float)view->drawn.y_px);
}
