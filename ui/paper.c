/* Lays out, draws and moves what page and search have in common. */
#include "ui/paper.h"

#include "ui/icon.h"
#include "ui/translate.h"

#define HEAD_MM  13.0f
#define CLOSE_MM 34.0f /* width of the close control */
#define SLIDE_MM 12

void paper_init(struct paper *paper, const struct theme *theme, uint32_t *next_id)
{
	int width_px = theme_px(theme, 1.0f);
	cairo_t *context;

	sprites_init(&paper->ground, 1, next_id);
	sprites_init(&paper->mark, 1, next_id);
	sprite_fill(&paper->ground, theme_paper);
	context = sprite_begin(&paper->mark, width_px, 4 * width_px);
	if (!context)
		return;
	theme_rounded(context, 0, 0, width_px, 4 * width_px, width_px / 2.0);
	theme_set_source(context, theme_ink_soft, 0.6);
	cairo_fill(context);
	sprite_end(&paper->mark, context);
}

void paper_finish(struct paper *paper)
{
	sprites_finish(&paper->ground, 1);
	sprites_finish(&paper->mark, 1);
}

/* ---- layout ---- */

struct rect paper_head(const struct screen *screen, struct rect all)
{
	if (screen_is_flat(screen)) {
		all.x_px = screen->width_px / 2;
		all.width_px = screen->width_px - all.x_px;
		all.y_px = screen->bar.y_px - screen_px(screen, THEME_GAP_MM);
		all.height_px = screen->height_px - all.y_px;
	} else {
		all.height_px = screen_px(screen, HEAD_MM);
	}
	return all;
}

struct rect paper_close(const struct screen *screen, struct rect head)
{
	int width_px = screen_text_px(screen, CLOSE_MM), gap_px = screen_px(screen, THEME_GAP_MM);

	return (struct rect){ head.x_px + head.width_px - width_px - gap_px, head.y_px + gap_px,
			      width_px, screen_px(screen, THEME_TARGET_MM) };
}

/* ---- drawing ---- */

static void draw_close(cairo_t *context, const struct screen *screen, int width_px, int height_px)
{
	const struct theme *theme = screen->theme;
	/* Translators: a button that closes a page, a picture or the search. */
	const char *text = translate(theme->language, "Close");
	PangoLayout *layout = theme_layout(theme, TEXT_BUTTON, text, -1);
	int label_px, text_px, cross_px = screen_px(screen, 3.0f);
	double x;

	theme_rounded(context, 0, 0, width_px, height_px, height_px / 2.0);
	theme_set_source(context, theme_accent, 1);
	cairo_fill(context);
	pango_layout_get_pixel_size(layout, &label_px, &text_px);
	theme_set_source(context, theme_paper, 1);
	x = (width_px - label_px - 2 * cross_px) / 2.0;
	cairo_move_to(context, x, (height_px - text_px) / 2.0);
	pango_cairo_show_layout(context, layout);
	icon_draw(context, ICON_CLOSE, x + label_px + 1.5 * cross_px, height_px / 2.0, cross_px);
	g_object_unref(layout);
}

void paper_draw_head(cairo_t *context, const struct screen *screen, struct rect head)
{
	const struct rect close = paper_close(screen, head);

	theme_set_source(context, theme_paper, 1);
	cairo_paint(context);
	cairo_rectangle(context, 0, screen_is_flat(screen) ? 0 : head.height_px - 1, head.width_px,
			1);
	theme_set_source(context, theme_line, 1);
	cairo_fill(context);
	cairo_save(context);
	cairo_translate(context, close.x_px - head.x_px, close.y_px - head.y_px);
	draw_close(context, screen, close.width_px, close.height_px);
	cairo_restore(context);
}

/* ---- layers ---- */

struct paper_slide paper_slide(const struct screen *screen, const struct fade *fade)
{
	const float alpha = fade_eased(fade);
	const float way_px = (1 - alpha) * SLIDE_MM * screen->theme->px_per_mm;
	const bool is_from_below = screen_is_portrait(screen) || screen_is_flat(screen);

	return (struct paper_slide){ .alpha = alpha,
				     .dx_px = is_from_below ? 0 : way_px,
				     .dy_px = is_from_below ? way_px : 0 };
}

void paper_add_ground(const struct paper *paper, struct layers *layers, struct paper_slide slide,
		      struct rect all)
{
	layers_add_stretched(layers, &paper->ground, slide.alpha, (float)all.x_px + slide.dx_px,
			     (float)all.y_px + slide.dy_px, (float)all.width_px,
			     (float)all.height_px);
}

void paper_add_at(struct layers *layers, const struct sprite *sprite, struct paper_slide slide,
		  struct rect at)
{
	layers_add_at(layers, sprite, slide.alpha, (float)at.x_px + slide.dx_px,
		      (float)at.y_px + slide.dy_px);
}

void paper_add_mark(const struct paper *paper, struct layers *layers, struct paper_slide slide,
		    struct rect window, float scroll_px, int most_px)
{
	const float width = (float)paper->mark.bitmap.width_px, most = (float)most_px;
	float height;

	if (most_px <= 0)
		return;
	height = (float)window.height_px * (float)window.height_px /
		 ((float)window.height_px + most);
	layers_add_stretched(layers, &paper->mark, slide.alpha,
			     (float)(window.x_px + window.width_px) - 2 * width + slide.dx_px,
			     (float)window.y_px +
				     scroll_px / most * ((float)window.height_px - height) +
				     slide.dy_px,
			     width, height);
}
