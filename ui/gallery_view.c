/* Places, zooms and swipes the pictures of a page. */
#include "ui/gallery_view.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "ui/icon.h"

#define MARGIN_MM  4.0f
#define CAPTION_MM 16.0f /* two lines of caption */
#define BUTTON_MM  13.0f /* the buttons: close, previous, next */

enum {
	PICTURE_MOST_PX = 2048, /* longest side of the bitmap; the GPU scales it further */
	UPSCALE_MAX = 2,        /* panel pixels per picture pixel, at most */
	SETTLE_MS = 90,         /* time constant of a swipe that settles (to 1/e) */
	FLICK_PX_PER_S = 500,
};

#define DOUBLE_TAP_ZOOM 2.5f
#define END_RESISTANCE  0.35f /* factor for a swipe beyond the first or last picture */

/* ---- what never changes ---- */

static void draw_button(struct sprite *sprite, const struct theme *theme, enum icon icon)
{
	int side_px = theme_px(theme, BUTTON_MM);
	cairo_t *context = sprite_begin(sprite, side_px, side_px);

	if (!context)
		return;
	theme_rounded(context, 0, 0, side_px, side_px, side_px / 2.0);
	theme_set_source(context, theme_night, THEME_BUTTON_ALPHA);
	cairo_fill(context);
	theme_set_source(context, theme_night_text, 1);
	icon_draw(context, icon, side_px / 2.0, side_px / 2.0, theme_px(theme, 4.5f));
	sprite_end(sprite, context);
}

void gallery_view_init(struct gallery_view *view, const struct theme *theme, uint32_t *next_id)
{
	static const enum icon icons[] = { [GALLERY_CLOSE] = ICON_CLOSE,
					   [GALLERY_BACK] = ICON_BACK,
					   [GALLERY_ON] = ICON_FORWARD };

	*view = (struct gallery_view){ 0 };
	for (int i = 0; i < GALLERY_SLOTS; i++)
		sprites_init(&view->slots[i].sprite, 1, next_id);
	sprites_init(&view->night, 1, next_id);
	sprites_init(&view->words, 1, next_id);
	sprites_init(view->buttons, GALLERY_BUTTONS, next_id);
	gallery_view_drop(view);
	sprite_fill(&view->night, theme_night);
	for (int i = 0; i < GALLERY_BUTTONS; i++)
		draw_button(&view->buttons[i], theme, icons[i]);
}

void gallery_view_finish(struct gallery_view *view)
{
	for (int i = 0; i < GALLERY_SLOTS; i++)
		sprites_finish(&view->slots[i].sprite, 1);
	sprites_finish(&view->night, 1);
	sprites_finish(&view->words, 1);
	sprites_finish(view->buttons, GALLERY_BUTTONS);
}

/* ---- layout ---- */

struct rect gallery_view_rect(const struct screen *screen)
{
	int bottom_px = screen->bar.y_px - screen_text_px(screen, CAPTION_MM);
	int margin_px = screen_px(screen, MARGIN_MM), height_px = bottom_px - 2 * margin_px;

	return (struct rect){ margin_px, margin_px, screen->width_px - 2 * margin_px,
			      height_px > 1 ? height_px : 1 };
}

struct rect gallery_view_button(const struct screen *screen, enum gallery_view_button button)
{
	int side_px = screen_px(screen, BUTTON_MM), margin_px = screen_px(screen, MARGIN_MM);
	struct rect view = gallery_view_rect(screen);
	struct rect rect = { screen->width_px - side_px - margin_px, margin_px, side_px, side_px };

	if (screen->reach) { /* at the lower end; close is above next */
		rect.y_px = view.y_px + view.height_px - side_px;
		if (button == GALLERY_CLOSE)
			rect.y_px -= side_px + screen_px(screen, THEME_GAP_MM);
	} else if (button != GALLERY_CLOSE) {
		rect.y_px = view.y_px + (view.height_px - side_px) / 2;
	}
	if (button == GALLERY_BACK)
		rect.x_px = margin_px;
	return rect;
}

/* Panel pixels per bitmap pixel when not zoomed. */
static float fit_scale(const struct screen *screen, const struct bitmap *bitmap)
{
	struct rect view = gallery_view_rect(screen);
	float wide = (float)view.width_px / (float)bitmap->width_px;
	float high = (float)view.height_px / (float)bitmap->height_px;

	return fminf(fminf(wide, high), UPSCALE_MAX);
}

bool gallery_view_place(const struct gallery_view *view, const struct screen *screen, int picture,
			float place_px[4])
{
	const struct gallery_view_slot *slot = &view->slots[picture % GALLERY_SLOTS];
	const struct bitmap *bitmap = &slot->sprite.bitmap;
	struct rect fit = gallery_view_rect(screen);
	float x, y, scale;

	if (slot->picture != picture || !bitmap->surface)
		return false;
	scale = fit_scale(screen, bitmap);
	x = (float)fit.x_px + (float)fit.width_px / 2 + view->swipe_px;
	y = (float)fit.y_px + (float)fit.height_px / 2;
	if (picture == view->at) {
		scale *= view->zoom;
		x += view->x_px;
		y += view->y_px;
	}
	x += (float)((picture - view->at) * screen->width_px);
	place_px[2] = scale * (float)bitmap->width_px;
	place_px[3] = scale * (float)bitmap->height_px;
	place_px[0] = x - place_px[2] / 2;
	place_px[1] = y - place_px[3] / 2;
	return true;
}

/* ---- state ---- */

static void forget_pictures(struct gallery_view *view)
{
	for (int i = 0; i < GALLERY_SLOTS; i++) {
		view->slots[i].picture = -1;
		view->slots[i].fade = (struct fade){ 0 };
	}
}

void gallery_view_show(struct gallery_view *view, const struct screen *screen, int picture,
		       int count)
{
	if (picture < 0 || picture >= count) {
		view->fade.on = false;
		return;
	}
	if (!view->fade.on) {
		forget_pictures(view);
		view->swipe_px = 0;
	} else {
		view->swipe_px += (float)((picture - view->at) * screen->width_px);
	}
	view->fade.on = true;
	view->count = count;
	view->at = picture;
	view->zoom = 1;
	view->x_px = view->y_px = 0;
	view->words_dirty = true;
}

void gallery_view_drop(struct gallery_view *view)
{
	forget_pictures(view);
	view->fade = (struct fade){ 0 };
	view->at = view->count = 0;
	view->zoom = view->x_px = view->y_px = view->swipe_px = 0;
	view->dragging = view->words_dirty = false;
}

void gallery_view_picture_arrived(struct gallery_view *view, const struct article_layout *article,
				  const char *name)
{
	for (int i = 0; i < GALLERY_SLOTS; i++) {
		struct gallery_view_slot *slot = &view->slots[i];

		if (slot->picture >= 0 &&
		    strcmp(article_layout_picture(article, (uint32_t)slot->picture, NULL), name) ==
			    0)
			slot->picture = -1; /* draw it again */
	}
}

/* ---- gestures ---- */

/* Moves a zoomed picture so that it covers the view, or is centred in it. */
static void keep_inside(struct gallery_view *view, const struct screen *screen)
{
	struct rect fit = gallery_view_rect(screen);
	float place[4], spare_x, spare_y;

	if (!gallery_view_place(view, screen, view->at, place))
		return;
	spare_x = fmaxf(0, (place[2] - (float)fit.width_px) / 2);
	spare_y = fmaxf(0, (place[3] - (float)fit.height_px) / 2);
	view->x_px = fminf(fmaxf(view->x_px, -spare_x), spare_x);
	view->y_px = fminf(fmaxf(view->y_px, -spare_y), spare_y);
}

static float zoom_most(const struct gallery_view *view, const struct screen *screen)
{
	const struct bitmap *bitmap = &view->slots[view->at % GALLERY_SLOTS].sprite.bitmap;

	if (!bitmap->surface)
		return 1;
	return fmaxf(DOUBLE_TAP_ZOOM, UPSCALE_MAX / fit_scale(screen, bitmap));
}

void gallery_view_pinch(struct gallery_view *view, const struct screen *screen, float x_px,
			float y_px, float scale, float dx_px, float dy_px)
{
	struct rect fit = gallery_view_rect(screen);
	float from = view->zoom, to = fminf(fmaxf(from * scale, 1), zoom_most(view, screen));
	float x = x_px - (float)fit.x_px - (float)fit.width_px / 2;
	float y = y_px - (float)fit.y_px - (float)fit.height_px / 2;

	/* The point under the fingers stays there. */
	view->x_px = x + (view->x_px - x) * to / from + dx_px;
	view->y_px = y + (view->y_px - y) * to / from + dy_px;
	view->zoom = to;
	view->swipe_px = 0;
	keep_inside(view, screen);
}

void gallery_view_double_tap(struct gallery_view *view, const struct screen *screen, float x_px,
			     float y_px)
{
	float zoom = view->zoom;

	gallery_view_pinch(view, screen, x_px, y_px, zoom > 1 ? 1 / zoom : DOUBLE_TAP_ZOOM, 0, 0);
}

static bool has(const struct gallery_view *view, int picture)
{
	return picture >= 0 && picture < view->count;
}

void gallery_view_drag(struct gallery_view *view, const struct screen *screen, float dx_px,
		       float dy_px)
{
	if (view->zoom > 1) {
		view->x_px += dx_px;
		view->y_px += dy_px;
		keep_inside(view, screen);
		return;
	}
	view->dragging = true;
	if (!has(view, view->at + (view->swipe_px + dx_px < 0 ? 1 : -1)))
		dx_px *= END_RESISTANCE;
	view->swipe_px += dx_px;
}

void gallery_view_drag_end(struct gallery_view *view, const struct screen *screen,
			   float vx_px_per_s)
{
	float way_px = view->swipe_px;
	int to = view->at + (way_px < 0 ? 1 : -1);
	bool far = fabsf(way_px) > (float)screen->width_px / 4;
	bool flicked = fabsf(vx_px_per_s) > FLICK_PX_PER_S && (vx_px_per_s < 0) == (way_px < 0);

	view->dragging = false;
	if (way_px != 0 && view->zoom == 1 && (far || flicked) && has(view, to))
		gallery_view_show(view, screen, to, view->count);
}

static bool is_on(const struct screen *screen, enum gallery_view_button button, float x_px,
		  float y_px)
{
	return rect_holds(gallery_view_button(screen, button), x_px, y_px);
}

struct overlay_action gallery_view_tap(const struct gallery_view *view, const struct screen *screen,
				       float x_px, float y_px)
{
	struct overlay_action action = { .kind = OVERLAY_SWALLOWED, .part = -1 };
	int to = view->at;

	if (is_on(screen, GALLERY_BACK, x_px, y_px))
		to--;
	else if (is_on(screen, GALLERY_ON, x_px, y_px))
		to++;
	if (is_on(screen, GALLERY_CLOSE, x_px, y_px))
		action = (struct overlay_action){ .kind = OVERLAY_PICTURE,
						  .part = -1,
						  .picture = -1 };
	else if (to != view->at && has(view, to))
		action = (struct overlay_action){ .kind = OVERLAY_PICTURE,
						  .part = -1,
						  .picture = to };
	return action;
}

/* ---- drawing ---- */

/* Draws a picture into its slot. Returns false if it has not arrived or memory ran out. */
static bool draw_picture(struct sprite *sprite, const struct picture_source *pictures,
			 const char *name)
{
	struct found_picture found = { 0 };
	struct bitmap fresh = { 0 };
	float width, height, shrink;
	int rc = -1;

	if (pictures->get && pictures->get(pictures->data, name, &found) && found.picture) {
		width = (float)found.picture->width;
		height = (float)found.picture->height;
		shrink = fminf(1, PICTURE_MOST_PX / fmaxf(width, height));
		/* If memory runs out, the place stays empty. */
		rc = bitmap_from_picture(&fresh, found.picture, (int)fmaxf(1, width * shrink),
					 (int)fmaxf(1, height * shrink));
	}
	sprite_take(sprite, &fresh, rc);
	return rc == 0;
}

static void draw_words(struct gallery_view *view, const struct screen *screen,
		       const struct article_layout *article)
{
	struct rect fit = gallery_view_rect(screen);
	cairo_t *context =
		sprite_begin(&view->words, fit.width_px, screen_text_px(screen, CAPTION_MM));
	const char *caption = "";
	char count[32], *text;
	PangoLayout *layout;

	if (!context)
		return;
	article_layout_picture(article, (uint32_t)view->at, &caption);
	snprintf(count, sizeof(count), "%d / %d", view->at + 1, view->count);
	text = view->count > 1 ? g_strconcat(count, *caption ? " · " : "", caption, NULL)
			       : g_strdup(caption);
	layout = theme_layout(screen->theme, TEXT_CAPTION, text, fit.width_px);
	theme_limit_lines(layout, fit.width_px, 2);
	pango_layout_set_alignment(layout, PANGO_ALIGN_CENTER);
	theme_set_source(context, theme_night_text, 1);
	cairo_move_to(context, 0, 0);
	pango_cairo_show_layout(context, layout);
	g_object_unref(layout);
	g_free(text);
	sprite_end(&view->words, context);
}

/* ---- a frame ---- */

/* Draws the current picture first, then its neighbours, one per frame. */
static bool update_slots(struct gallery_view *view, const struct article_layout *article,
			 const struct picture_source *pictures, int64_t step_ms)
{
	static const int order[] = { 0, 1, -1 };
	bool drew = false, moving = false;

	for (size_t i = 0; i < ARRAY_COUNT(order); i++) {
		int picture = view->at + order[i];
		struct gallery_view_slot *slot;

		if (!has(view, picture))
			continue;
		slot = &view->slots[picture % GALLERY_SLOTS];
		if (slot->picture != picture && drew) {
			moving = true;
			continue;
		}
		if (slot->picture != picture) {
			slot->picture = picture;
			slot->fade.alpha = 0;
			slot->fade.on = draw_picture(
				&slot->sprite, pictures,
				article_layout_picture(article, (uint32_t)picture, NULL));
			drew = true;
		}
		moving |= fade_advance(&slot->fade, step_ms);
	}
	return moving;
}

bool gallery_view_update(struct gallery_view *view, const struct screen *screen,
			 const struct article_layout *article,
			 const struct picture_source *pictures, int64_t step_ms)
{
	bool moving = fade_advance(&view->fade, step_ms);

	if (!view->fade.on || !article)
		return moving;
	if (view->words_dirty)
		draw_words(view, screen, article);
	view->words_dirty = false;
	moving |= update_slots(view, article, pictures, step_ms);
	if (!view->dragging && view->swipe_px != 0) {
		view->swipe_px *= expf(-(float)step_ms / SETTLE_MS);
		if (fabsf(view->swipe_px) < 0.5f)
			view->swipe_px = 0;
		moving |= view->swipe_px != 0;
	}
	return moving;
}

void gallery_view_layers(const struct gallery_view *view, const struct screen *screen,
			 struct layers *layers)
{
	struct rect fit = gallery_view_rect(screen);
	float alpha = fade_eased(&view->fade);

	if (alpha <= 0)
		return;
	layers_add_stretched(layers, &view->night, alpha, 0, 0, (float)screen->width_px,
			     (float)screen->height_px);
	for (int picture = view->at - 1; picture <= view->at + 1; picture++) {
		const struct gallery_view_slot *slot;
		float place[4];

		if (!has(view, picture) || !gallery_view_place(view, screen, picture, place) ||
		    place[0] >= (float)screen->width_px || place[0] + place[2] <= 0)
			continue;
		slot = &view->slots[picture % GALLERY_SLOTS];
		layers_add_stretched(layers, &slot->sprite, alpha * fade_eased(&slot->fade),
				     place[0], place[1], place[2], place[3]);
	}
	if (view->zoom == 1)
		layers_add_at(layers, &view->words, alpha, (float)fit.x_px,
			      (float)(fit.y_px + fit.height_px) + 2 * screen->theme->px_per_mm);
	for (int i = 0; i < GALLERY_BUTTONS; i++) {
		struct rect rect = gallery_view_button(screen, (enum gallery_view_button)i);

		if ((i == GALLERY_BACK && view->at == 0) ||
		    (i == GALLERY_ON && view->at + 1 >= view->count))
			continue;
		layers_add_at(layers, &view->buttons[i], alpha, (float)rect.x_px, (float)rect.y_px);
	}
}
