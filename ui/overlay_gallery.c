/* The gallery shows the pictures of the open page one at a time over the whole panel. Two fingers
 * zoom. One finger moves a zoomed picture, else it swipes to the next. The bar stays visible over
 * it. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ui/icon.h"
#include "ui/overlay_state.h"

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

static int px(const struct overlay *overlay, float mm)
{
	return theme_px(&overlay->theme, mm);
}

/* ---- layout ---- */

/* The place of a picture that is not zoomed: above its caption, which is above the bar. */
struct rect overlay_gallery_rect(const struct overlay *overlay)
{
	int bottom_px =
		overlay_chrome_rect(overlay).y_px - theme_text_px(&overlay->theme, CAPTION_MM);
	int margin_px = px(overlay, MARGIN_MM);

	return (struct rect){ margin_px, margin_px, overlay->width_px - 2 * margin_px,
			      bottom_px - 2 * margin_px > 1 ? bottom_px - 2 * margin_px : 1 };
}

struct rect overlay_gallery_button(const struct overlay *overlay, enum gallery_button button)
{
	int side_px = px(overlay, BUTTON_MM), margin_px = px(overlay, MARGIN_MM);
	struct rect view = overlay_gallery_rect(overlay);
	struct rect rect = { overlay->width_px - side_px - margin_px, margin_px, side_px, side_px };

	if (overlay->comfort.reach) { /* at the lower end; close is above next */
		rect.y_px = view.y_px + view.height_px - side_px;
		if (button == GALLERY_CLOSE)
			rect.y_px -= side_px + px(overlay, THEME_GAP_MM);
	} else if (button != GALLERY_CLOSE) {
		rect.y_px = view.y_px + (view.height_px - side_px) / 2;
	}
	if (button == GALLERY_BACK)
		rect.x_px = margin_px;
	return rect;
}

static struct sprite *sprite_of(struct overlay *overlay, int picture)
{
	return &overlay->sprites[BITMAP_PICTURE + picture % GALLERY_SLOTS];
}

/* Panel pixels per bitmap pixel when not zoomed. */
static float fit_scale(const struct overlay *overlay, const struct bitmap *bitmap)
{
	struct rect view = overlay_gallery_rect(overlay);
	float wide = (float)view.width_px / (float)bitmap->width_px;
	float high = (float)view.height_px / (float)bitmap->height_px;

	return fminf(fminf(wide, high), UPSCALE_MAX);
}

/* Sets left, top, width and height of a picture. Returns false if it is not drawn yet. */
bool overlay_gallery_place(const struct overlay *overlay, int picture, float place_px[4])
{
	const struct gallery *gallery = &overlay->gallery;
	const struct gallery_slot *slot = &gallery->slots[picture % GALLERY_SLOTS];
	const struct bitmap *bitmap =
		&overlay->sprites[BITMAP_PICTURE + picture % GALLERY_SLOTS].bitmap;
	struct rect view = overlay_gallery_rect(overlay);
	float x, y, scale;

	if (slot->picture != picture || !bitmap->surface)
		return false;
	scale = fit_scale(overlay, bitmap);
	x = (float)view.x_px + (float)view.width_px / 2 + gallery->swipe_px;
	y = (float)view.y_px + (float)view.height_px / 2;
	if (picture == gallery->at) {
		scale *= gallery->zoom;
		x += gallery->x_px;
		y += gallery->y_px;
	}
	x += (float)((picture - gallery->at) * overlay->width_px);
	place_px[2] = scale * (float)bitmap->width_px;
	place_px[3] = scale * (float)bitmap->height_px;
	place_px[0] = x - place_px[2] / 2;
	place_px[1] = y - place_px[3] / 2;
	return true;
}

/* ---- state ---- */

void overlay_show_picture(struct overlay *overlay, int picture)
{
	struct gallery *gallery = &overlay->gallery;

	if (!overlay->article || picture >= (int)article_picture_count(overlay->article))
		picture = -1;
	if (picture < 0) {
		gallery->fade.on = false;
		return;
	}
	if (!gallery->fade.on) {
		for (int i = 0; i < GALLERY_SLOTS; i++)
			gallery->slots[i] = (struct gallery_slot){ .picture = -1 };
		gallery->swipe_px = 0;
	} else {
		gallery->swipe_px += (float)((picture - gallery->at) * overlay->width_px);
	}
	gallery->fade.on = true;
	gallery->count = (int)article_picture_count(overlay->article);
	gallery->at = picture;
	gallery->zoom = 1;
	gallery->x_px = gallery->y_px = 0;
	gallery->words_dirty = true;
}

int overlay_picture(const struct overlay *overlay)
{
	return overlay->gallery.fade.on ? overlay->gallery.at : -1;
}

/* Moves a zoomed picture so that it covers the view, or is centred in it. */
static void keep_inside(struct overlay *overlay)
{
	struct gallery *gallery = &overlay->gallery;
	struct rect view = overlay_gallery_rect(overlay);
	float place[4], spare_x, spare_y;

	if (!overlay_gallery_place(overlay, gallery->at, place))
		return;
	spare_x = fmaxf(0, (place[2] - (float)view.width_px) / 2);
	spare_y = fmaxf(0, (place[3] - (float)view.height_px) / 2);
	gallery->x_px = fminf(fmaxf(gallery->x_px, -spare_x), spare_x);
	gallery->y_px = fminf(fmaxf(gallery->y_px, -spare_y), spare_y);
}

static float zoom_most(struct overlay *overlay)
{
	const struct bitmap *bitmap = &sprite_of(overlay, overlay->gallery.at)->bitmap;

	if (!bitmap->surface)
		return 1;
	return fmaxf(DOUBLE_TAP_ZOOM, UPSCALE_MAX / fit_scale(overlay, bitmap));
}

void overlay_picture_pinch(struct overlay *overlay, float x_px, float y_px, float scale,
			   float dx_px, float dy_px)
{
	struct gallery *gallery = &overlay->gallery;
	struct rect view = overlay_gallery_rect(overlay);
	float from = gallery->zoom, to = fminf(fmaxf(from * scale, 1), zoom_most(overlay));
	float x = x_px - (float)view.x_px - (float)view.width_px / 2;
	float y = y_px - (float)view.y_px - (float)view.height_px / 2;

	/* The point under the fingers stays there. */
	gallery->x_px = x + (gallery->x_px - x) * to / from + dx_px;
	gallery->y_px = y + (gallery->y_px - y) * to / from + dy_px;
	gallery->zoom = to;
	gallery->swipe_px = 0;
	keep_inside(overlay);
}

void overlay_picture_double_tap(struct overlay *overlay, float x_px, float y_px)
{
	float zoom = overlay->gallery.zoom;

	overlay_picture_pinch(overlay, x_px, y_px, zoom > 1 ? 1 / zoom : DOUBLE_TAP_ZOOM, 0, 0);
}

static bool has(const struct gallery *gallery, int picture)
{
	return picture >= 0 && picture < gallery->count;
}

void overlay_picture_drag(struct overlay *overlay, float dx_px, float dy_px)
{
	struct gallery *gallery = &overlay->gallery;

	if (gallery->zoom > 1) {
		gallery->x_px += dx_px;
		gallery->y_px += dy_px;
		keep_inside(overlay);
		return;
	}
	gallery->dragging = true;
	if (!has(gallery, gallery->at + (gallery->swipe_px + dx_px < 0 ? 1 : -1)))
		dx_px *= END_RESISTANCE;
	gallery->swipe_px += dx_px;
}

void overlay_picture_drag_end(struct overlay *overlay, float vx_px_per_s)
{
	struct gallery *gallery = &overlay->gallery;
	float way_px = gallery->swipe_px;
	int to = gallery->at + (way_px < 0 ? 1 : -1);
	bool far = fabsf(way_px) > (float)overlay->width_px / 4;
	bool flicked = fabsf(vx_px_per_s) > FLICK_PX_PER_S && (vx_px_per_s < 0) == (way_px < 0);

	gallery->dragging = false;
	if (way_px != 0 && gallery->zoom == 1 && (far || flicked) && has(gallery, to))
		overlay_show_picture(overlay, to);
}

void overlay_gallery_arrived(struct overlay *overlay, const char *name)
{
	struct gallery *gallery = &overlay->gallery;

	for (int i = 0; overlay->article && i < GALLERY_SLOTS; i++)
		if (gallery->slots[i].picture >= 0 &&
		    strcmp(article_picture(overlay->article, (uint32_t)gallery->slots[i].picture,
					   NULL),
			   name) == 0)
			gallery->slots[i].picture = -1; /* draw it again */
}

/* ---- touch ---- */

static bool is_on(const struct overlay *overlay, enum gallery_button button, float x_px, float y_px)
{
	return rect_holds(overlay_gallery_button(overlay, button), x_px, y_px);
}

struct overlay_action overlay_gallery_tap(const struct overlay *overlay, float x_px, float y_px)
{
	const struct gallery *gallery = &overlay->gallery;
	struct overlay_action action = { .kind = OVERLAY_SWALLOWED, .part = -1 };
	int to = gallery->at;

	if (is_on(overlay, GALLERY_BACK, x_px, y_px))
		to--;
	else if (is_on(overlay, GALLERY_ON, x_px, y_px))
		to++;
	if (is_on(overlay, GALLERY_CLOSE, x_px, y_px))
		action = (struct overlay_action){ .kind = OVERLAY_PICTURE,
						  .part = -1,
						  .picture = -1 };
	else if (to != gallery->at && has(gallery, to))
		action = (struct overlay_action){ .kind = OVERLAY_PICTURE,
						  .part = -1,
						  .picture = to };
	return action;
}

/* ---- drawing ---- */

/* Draws a picture into its slot. Returns false if it has not arrived or memory ran out. */
static bool draw_picture(struct overlay *overlay, int picture)
{
	struct sprite *sprite = sprite_of(overlay, picture);
	const char *name = article_picture(overlay->article, (uint32_t)picture, NULL);
	struct overlay_picture found = { 0 };
	float width, height, shrink;

	bitmap_finish(&sprite->bitmap);
	sprite->revision++;
	if (!overlay->pictures.get ||
	    !overlay->pictures.get(overlay->pictures.data, name, &found) || !found.picture)
		return false;
	width = (float)found.picture->width;
	height = (float)found.picture->height;
	shrink = fminf(1, PICTURE_MOST_PX / fmaxf(width, height));
	/* If memory runs out, the place stays empty. */
	if (bitmap_from_picture(&sprite->bitmap, found.picture, (int)fmaxf(1, width * shrink),
				(int)fmaxf(1, height * shrink)) < 0)
		bitmap_finish(&sprite->bitmap);
	return sprite->bitmap.surface != NULL;
}

static void draw_words(struct overlay *overlay)
{
	const struct gallery *gallery = &overlay->gallery;
	struct rect view = overlay_gallery_rect(overlay);
	cairo_t *context = overlay_begin(overlay, BITMAP_PICTURE_WORDS, view.width_px,
					 theme_text_px(&overlay->theme, CAPTION_MM));
	const char *caption = "";
	char count[32], *text;
	PangoLayout *layout;
	int width_px, height_px;

	if (!context)
		return;
	article_picture(overlay->article, (uint32_t)gallery->at, &caption);
	snprintf(count, sizeof(count), "%d / %d", gallery->at + 1, gallery->count);
	text = gallery->count > 1 ? g_strconcat(count, *caption ? " · " : "", caption, NULL)
				  : g_strdup(caption);
	layout = theme_layout(&overlay->theme, TEXT_CAPTION, text, view.width_px);
	theme_limit_lines(layout, view.width_px, 2);
	pango_layout_set_alignment(layout, PANGO_ALIGN_CENTER);
	pango_layout_get_pixel_size(layout, &width_px, &height_px);
	theme_set_source(context, theme_night_text, 1);
	cairo_move_to(context, 0, 0);
	pango_cairo_show_layout(context, layout);
	g_object_unref(layout);
	g_free(text);
	overlay_end(overlay, BITMAP_PICTURE_WORDS, context);
}

/* Drawn once; they never change. */
void overlay_draw_gallery_buttons(struct overlay *overlay)
{
	static const enum icon icons[] = { [GALLERY_CLOSE] = ICON_CLOSE,
					   [GALLERY_BACK] = ICON_BACK,
					   [GALLERY_ON] = ICON_FORWARD };
	int side_px = px(overlay, BUTTON_MM);

	for (int i = 0; i < GALLERY_BUTTONS; i++) {
		enum bitmap_id id = (enum bitmap_id)(BITMAP_PICTURE_BUTTON + i);
		cairo_t *context = overlay_begin(overlay, id, side_px, side_px);

		if (!context)
			continue;
		theme_rounded(context, 0, 0, side_px, side_px, side_px / 2.0);
		theme_set_source(context, theme_night, THEME_BUTTON_ALPHA);
		cairo_fill(context);
		theme_set_source(context, theme_night_text, 1);
		icon_draw(context, icons[i], side_px / 2.0, side_px / 2.0, px(overlay, 4.5f));
		overlay_end(overlay, id, context);
	}
}

/* ---- a frame ---- */

/* Draws the current picture first, then its neighbours, one per frame. */
static bool update_slots(struct overlay *overlay, int64_t step_ms)
{
	static const int order[] = { 0, 1, -1 };
	struct gallery *gallery = &overlay->gallery;
	bool drew = false, moving = false;

	for (size_t i = 0; i < ARRAY_COUNT(order); i++) {
		int picture = gallery->at + order[i];
		struct gallery_slot *slot;

		if (!has(gallery, picture))
			continue;
		slot = &gallery->slots[picture % GALLERY_SLOTS];
		if (slot->picture != picture && drew) {
			moving = true;
			continue;
		}
		if (slot->picture != picture) {
			*slot = (struct gallery_slot){ .picture = picture };
			slot->fade.on = draw_picture(overlay, picture);
			drew = true;
		}
		moving |= fade_advance(&slot->fade, step_ms);
	}
	return moving;
}

bool overlay_update_gallery(struct overlay *overlay, int64_t step_ms)
{
	struct gallery *gallery = &overlay->gallery;
	bool moving = fade_advance(&gallery->fade, step_ms);

	if (!gallery->fade.on || !overlay->article)
		return moving;
	if (gallery->words_dirty)
		draw_words(overlay);
	gallery->words_dirty = false;
	moving |= update_slots(overlay, step_ms);
	if (!gallery->dragging && gallery->swipe_px != 0) {
		gallery->swipe_px *= expf(-(float)step_ms / SETTLE_MS);
		if (fabsf(gallery->swipe_px) < 0.5f)
			gallery->swipe_px = 0;
		moving |= gallery->swipe_px != 0;
	}
	return moving;
}
