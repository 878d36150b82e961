/* Draws the card of a part and finds its close control. */
#include "ui/card_view.h"

#include <math.h>

#include "ui/icon.h"
#include "ui/translate.h"

/* Millimetres. */
#define WIDTH_MM   118.0f
#define HEIGHT_MM  36.0f
#define SHADOW_MM  1.5f
#define PADDING_MM 3.0f

void card_view_init(struct card_view *view, uint32_t *next_id)
{
	*view = (struct card_view){ .part = -1 };
	sprites_init(&view->sprite, 1, next_id);
}

void card_view_finish(struct card_view *view)
{
	sprites_finish(&view->sprite, 1);
}

bool card_view_show(struct card_view *view, int part)
{
	if (part == view->part)
		return false;
	view->part = part;
	view->fade.on = part >= 0;
	if (part < 0)
		return true;
	if (view->shown != part)
		view->fade.alpha = 0;
	view->shown = part;
	view->dirty = true;
	return true;
}

void card_view_drop(struct card_view *view)
{
	view->fade = (struct fade){ 0 };
	view->part = -1;
}

/* ---- layout and touch ---- */

struct rect card_view_rect(const struct screen *screen)
{
	int most_px = screen->scene.width_px - 2 * screen_px(screen, THEME_GAP_MM);
	int width_px = screen_text_px(screen, WIDTH_MM);

	return screen_above_floor(screen, width_px < most_px ? width_px : most_px,
				  screen_text_px(screen, HEIGHT_MM));
}

static bool closes(const struct theme *theme, int width_px, float x_px, float y_px)
{
	int reach = theme_px(theme, THEME_TARGET_MM) + theme_px(theme, SHADOW_MM);

	if (theme_is_right_to_left(theme))
		x_px = (float)width_px - x_px;
	return x_px >= (float)(width_px - reach) && y_px <= (float)reach;
}

struct overlay_action card_view_tap(const struct card_view *view, const struct screen *screen,
				    const struct parts *parts, float x_px, float y_px)
{
	struct overlay_action action = { .kind = OVERLAY_SWALLOWED, .part = view->part };
	struct rect rect = card_view_rect(screen);

	if (closes(screen->theme, rect.width_px, x_px - (float)rect.x_px, y_px - (float)rect.y_px))
		action.kind = OVERLAY_CLOSE_CARD;
	else if (parts->list[view->part].has_page)
		action.kind = OVERLAY_OPEN_PAGE;
	return action;
}

/* ---- drawing ---- */

/* Draws paper with a soft edge: rings of faint shadow, the widest first. */
static void draw_paper(const struct theme *theme, cairo_t *context, int width_px, int height_px)
{
	double shadow = theme_px(theme, SHADOW_MM), radius = theme_px(theme, THEME_RADIUS_MM);

	for (int i = 0; i < 5; i++) {
		double in = shadow * i / 5;

		theme_rounded(context, in, in, width_px - 2 * in, height_px - 2 * in,
			      radius + shadow - in);
		theme_set_source(context, theme_night, 0.07);
		cairo_fill(context);
	}
	theme_rounded(context, shadow, shadow, width_px - 2 * shadow, height_px - 2 * shadow,
		      radius);
	theme_set_source(context, theme_paper, 1);
	cairo_fill(context);
}

/* Returns the left edge of an item that is x_px from the side where lines of the language begin. */
static int mirrored(const struct theme *theme, int all_px, int x_px, int width_px)
{
	return theme_is_right_to_left(theme) ? all_px - x_px - width_px : x_px;
}

/* Returns where the text may begin, counted from that side. Until the picture has arrived, or if
 * scaling runs out of memory, its place is shaded. */
static int draw_thumbnail(const struct theme *theme, cairo_t *context, const char *name,
			  const struct picture_source *pictures, int width_px, int height_px)
{
	int padding = theme_px(theme, SHADOW_MM) + theme_px(theme, PADDING_MM) / 2;
	int side = height_px - 2 * padding;
	int x_px = mirrored(theme, width_px, padding, side);
	struct found_picture found = { 0 };
	struct bitmap scaled;

	if (!*name || !pictures->get || !pictures->get(pictures->data, name, &found))
		return padding + theme_px(theme, PADDING_MM);
	cairo_save(context);
	theme_rounded(context, x_px, padding, side, side, theme_px(theme, 0.8f));
	cairo_clip(context);
	theme_set_source(context, theme_paper_shade, 1);
	cairo_paint(context);
	if (found.picture && bitmap_from_picture(&scaled, found.picture, side, side) == 0) {
		cairo_set_source_surface(context, scaled.surface, x_px, padding);
		cairo_paint(context);
		bitmap_finish(&scaled);
	}
	cairo_restore(context);
	return padding + side + theme_px(theme, PADDING_MM);
}

static int draw_text(const struct theme *theme, cairo_t *context, enum text_style style,
		     struct colour colour, const char *text, int x_px, int y_px, int width_px,
		     int lines)
{
	PangoLayout *layout = theme_layout(theme, style, text, width_px);
	int height_px;

	theme_limit_lines(layout, width_px, lines);
	theme_set_source(context, colour, 1);
	cairo_move_to(context, x_px, y_px);
	pango_cairo_show_layout(context, layout);
	pango_layout_get_pixel_size(layout, NULL, &height_px);
	g_object_unref(layout);
	return height_px;
}

static int text_height(const struct theme *theme, enum text_style style, const char *text,
		       int width_px, int lines)
{
	PangoLayout *layout = theme_layout(theme, style, text, width_px);
	int height_px;

	theme_limit_lines(layout, width_px, lines);
	pango_layout_get_pixel_size(layout, NULL, &height_px);
	g_object_unref(layout);
	return height_px;
}

/* Draws "Read more >" at the bottom, where lines end. Returns the height it takes. */
static int draw_more(const struct theme *theme, cairo_t *context, int card_px, int right_px,
		     int bottom_px)
{
	const char *text = translate(theme->language, "Read more");
	const enum icon onward = theme_is_right_to_left(theme) ? ICON_BACK : ICON_FORWARD;
	PangoLayout *layout = theme_layout(theme, TEXT_BUTTON, text, -1);
	int width_px, height_px, arrow_px = theme_px(theme, 2.4f);

	pango_layout_get_pixel_size(layout, &width_px, &height_px);
	theme_set_source(context, theme_accent, 1);
	cairo_move_to(context,
		      mirrored(theme, card_px, right_px - width_px - 2 * arrow_px, width_px),
		      bottom_px - height_px);
	pango_cairo_show_layout(context, layout);
	g_object_unref(layout);
	icon_draw(context, onward,
		  mirrored(theme, card_px, right_px - arrow_px, arrow_px) + arrow_px / 2.0,
		  bottom_px - height_px / 2.0, arrow_px);
	return height_px;
}

static void draw(struct sprite *sprite, const struct screen *screen,
		 const struct overlay_part *part, const struct picture_source *pictures)
{
	const struct theme *theme = screen->theme;
	const int width_px = card_view_rect(screen).width_px;
	const int height_px = card_view_rect(screen).height_px;
	int shadow = theme_px(theme, SHADOW_MM), padding = theme_px(theme, PADDING_MM);
	int close = theme_px(theme, THEME_TARGET_MM), x_px, y_px, right_px, bottom_px, room_px;
	int title_px;
	cairo_t *context = sprite_begin(sprite, width_px, height_px);

	if (!context)
		return;
	draw_paper(theme, context, width_px, height_px);
	x_px = draw_thumbnail(theme, context, part->thumbnail, pictures, width_px, height_px);
	right_px = width_px - shadow - padding;
	bottom_px = height_px - shadow - padding / 2 - theme_px(theme, 0.8f);
	if (part->has_page)
		bottom_px -= draw_more(theme, context, width_px, right_px, bottom_px);
	y_px = shadow + padding;
	room_px = right_px - close - x_px > 1 ? right_px - close - x_px : 1;
	title_px = text_height(theme, TEXT_TITLE, part->title, room_px, 2);
	draw_text(theme, context, TEXT_TITLE, theme_ink, part->title,
		  mirrored(theme, width_px, x_px, room_px), y_px, room_px, 2);
	y_px += title_px + theme_px(theme, 1.0f);
	for (int lines = 3; lines > 0; lines--) { /* as many lines as fit */
		int caption_px =
			text_height(theme, TEXT_CAPTION, part->caption, right_px - x_px, lines);

		/* At least one line is drawn: fonts with tall lines leave them mostly empty. */
		if (lines > 1 && y_px + caption_px > bottom_px)
			continue;
		draw_text(theme, context, TEXT_CAPTION, theme_ink_soft, part->caption,
			  mirrored(theme, width_px, x_px, right_px - x_px), y_px, right_px - x_px,
			  lines);
		break;
	}
	theme_set_source(context, theme_ink_soft, 1);
	icon_draw(context, ICON_CLOSE,
		  mirrored(theme, width_px, width_px - shadow - close, close) + close / 2.0,
		  shadow + close / 2.0, theme_px(theme, 3.2f));
	sprite_end(sprite, context);
}

/* ---- a frame ---- */

bool card_view_update(struct card_view *view, const struct screen *screen,
		      const struct parts *parts, const struct picture_source *pictures,
		      int64_t step_ms)
{
	if (view->dirty && view->part >= 0)
		draw(&view->sprite, screen, &parts->list[view->part], pictures);
	view->dirty = false;
	return fade_advance(&view->fade, step_ms);
}

void card_view_layers(const struct card_view *view, const struct screen *screen,
		      struct layers *layers)
{
	const struct rect rect = card_view_rect(screen);

	layers_add_at(layers, &view->sprite, fade_eased(&view->fade), (float)rect.x_px,
		      (float)rect.y_px);
}
