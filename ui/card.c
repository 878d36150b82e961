/* Draws the card of a part and finds its close control. */
#include "ui/card.h"

#include <math.h>

#include "ui/icon.h"
#include "ui/translate.h"

/* Millimetres. */
#define WIDTH_MM   118.0f
#define HEIGHT_MM  36.0f
#define SHADOW_MM  1.5f
#define PADDING_MM 3.0f

void card_size(const struct theme *theme, int most_width_px, int *width_px, int *height_px)
{
	*width_px = theme_text_px(theme, WIDTH_MM);
	*height_px = theme_text_px(theme, HEIGHT_MM);
	if (*width_px > most_width_px)
		*width_px = most_width_px;
}

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

/* Returns where the text may begin, counted from that side. If scaling runs out of memory, the
 * place stays shaded. */
static int draw_thumbnail(const struct theme *theme, cairo_t *context, const struct card *card,
			  int width_px, int height_px)
{
	int padding = theme_px(theme, SHADOW_MM) + theme_px(theme, PADDING_MM) / 2;
	int side = height_px - 2 * padding;
	int x_px = mirrored(theme, width_px, padding, side);
	struct bitmap scaled;

	if (!card->has_thumbnail)
		return padding + theme_px(theme, PADDING_MM);
	cairo_save(context);
	theme_rounded(context, x_px, padding, side, side, theme_px(theme, 0.8f));
	cairo_clip(context);
	theme_set_source(context, theme_paper_shade, 1);
	cairo_paint(context);
	if (card->thumbnail && bitmap_from_picture(&scaled, card->thumbnail, side, side) == 0) {
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

int card_draw(struct bitmap *out, const struct theme *theme, const struct card *card, int width_px,
	      int height_px)
{
	int shadow = theme_px(theme, SHADOW_MM), padding = theme_px(theme, PADDING_MM);
	int close = theme_px(theme, THEME_TARGET_MM), x_px, y_px, right_px, bottom_px, room_px;
	int title_px;
	cairo_t *context;
	int rc = bitmap_init(out, width_px, height_px);

	if (rc < 0)
		return rc;
	context = bitmap_begin(out);
	draw_paper(theme, context, width_px, height_px);
	x_px = draw_thumbnail(theme, context, card, width_px, height_px);
	right_px = width_px - shadow - padding;
	bottom_px = height_px - shadow - padding / 2 - theme_px(theme, 0.8f);
	if (card->has_page)
		bottom_px -= draw_more(theme, context, width_px, right_px, bottom_px);
	y_px = shadow + padding;
	room_px = right_px - close - x_px > 1 ? right_px - close - x_px : 1;
	title_px = text_height(theme, TEXT_TITLE, card->title, room_px, 2);
	draw_text(theme, context, TEXT_TITLE, theme_ink, card->title,
		  mirrored(theme, width_px, x_px, room_px), y_px, room_px, 2);
	y_px += title_px + theme_px(theme, 1.0f);
	for (int lines = 3; lines > 0; lines--) { /* as many lines as fit */
		int caption_px =
			text_height(theme, TEXT_CAPTION, card->caption, right_px - x_px, lines);

		/* At least one line is drawn: fonts with tall lines leave them mostly empty. */
		if (lines > 1 && y_px + caption_px > bottom_px)
			continue;
		draw_text(theme, context, TEXT_CAPTION, theme_ink_soft, card->caption,
			  mirrored(theme, width_px, x_px, right_px - x_px), y_px, right_px - x_px,
			  lines);
		break;
	}
	theme_set_source(context, theme_ink_soft, 1);
	icon_draw(context, ICON_CLOSE,
		  mirrored(theme, width_px, width_px - shadow - close, close) + close / 2.0,
		  shadow + close / 2.0, theme_px(theme, 3.2f));
	bitmap_end(out, context);
	return 0;
}

bool card_closes(const struct theme *theme, int width_px, float x_px, float y_px)
{
	int reach = theme_px(theme, THEME_TARGET_MM) + theme_px(theme, SHADOW_MM);

	if (theme_is_right_to_left(theme))
		x_px = (float)width_px - x_px;
	return x_px >= (float)(width_px - reach) && y_px <= (float)reach;
}
