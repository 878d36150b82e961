/* Places a page, scrolls it, and draws its strips as they come into view. */
#include "ui/page_view.h"

#include <math.h>

#include "ui/icon.h"
#include "ui/translate.h"

#define MARGIN_MM 8.0f /* of the title in the head */
#define FOOT_MM   8.0f

enum {
	PAGE_FADE_MS = 110, /* the page is fully visible within 150 ms of the tap */
	STRIP_PX = 256,
	STRIPS_A_FRAME = 1, /* so that opening a page drops no frame */
};

/* ---- creation ---- */

static void draw_foot(struct sprite *sprite, const struct theme *theme)
{
	const struct colour c = theme_paper;
	int height_px = theme_px(theme, FOOT_MM);
	cairo_t *context = sprite_begin(sprite, 4, height_px);
	cairo_pattern_t *gradient;

	if (!context)
		return;
	gradient = cairo_pattern_create_linear(0, 0, 0, height_px);
	cairo_pattern_add_color_stop_rgba(gradient, 0, c.red, c.green, c.blue, 0);
	cairo_pattern_add_color_stop_rgba(gradient, 1, c.red, c.green, c.blue, 1);
	cairo_set_source(context, gradient);
	cairo_paint(context);
	cairo_pattern_destroy(gradient);
	sprite_end(sprite, context);
}

static void forget_strips(struct page_view *view)
{
	for (uint32_t i = 0; i < PAGE_STRIPS; i++) {
		struct page_view_strip *strip = &view->strips[i];

		*strip = (struct page_view_strip){ .index = -1, .sprite = strip->sprite };
	}
}

void page_view_init(struct page_view *view, const struct theme *theme, int height_px,
		    uint32_t *next_id)
{
	const int least_px = height_px / (PAGE_STRIPS - 4);

	*view = (struct page_view){ .part = -1,
				    .strip_px = least_px > STRIP_PX ? least_px : STRIP_PX };
	for (uint32_t i = 0; i < PAGE_STRIPS; i++)
		sprites_init(&view->strips[i].sprite, 1, next_id);
	sprites_init(&view->head, 1, next_id);
	sprites_init(&view->foot, 1, next_id);
	spoken_view_init(&view->spoken, next_id);
	forget_strips(view);
	draw_foot(&view->foot, theme);
}

void page_view_finish(struct page_view *view)
{
	article_layout_destroy(view->article);
	for (uint32_t i = 0; i < PAGE_STRIPS; i++)
		sprites_finish(&view->strips[i].sprite, 1);
	sprites_finish(&view->head, 1);
	sprites_finish(&view->foot, 1);
	spoken_view_finish(&view->spoken);
}

/* ---- layout ---- */

struct rect page_view_rect(const struct page_view *view, const struct screen *screen)
{
	if (view->wide)
		return (struct rect){ 0, 0, screen->width_px, screen->height_px };
	return screen_half(screen);
}

static struct rect head_rect(const struct page_view *view, const struct screen *screen)
{
	return paper_head(screen, page_view_rect(view, screen));
}

struct rect page_view_window(const struct page_view *view, const struct screen *screen)
{
	struct rect rect = page_view_rect(view, screen);
	int head_px = screen_is_flat(screen) ? 0 : head_rect(view, screen).height_px;

	rect.y_px += head_px;
	rect.height_px -= head_px;
	if (rect.x_px ==
	    0) /* it is below the model or has the whole panel, so the bar is over it */
		rect.height_px -= screen->bar.height_px + 2 * screen_px(screen, THEME_GAP_MM);
	if (rect.height_px < 1)
		rect.height_px = 1;
	return rect;
}

struct rect page_view_close_button(const struct page_view *view, const struct screen *screen)
{
	return paper_close(screen, head_rect(view, screen));
}

struct rect page_view_widen_button(const struct page_view *view, const struct screen *screen)
{
	struct rect close = page_view_close_button(view, screen);
	int side_px = screen_px(screen, THEME_TARGET_MM);

	if (screen->reach)
		return (struct rect){ 0 };
	return (struct rect){ close.x_px - screen_px(screen, THEME_GAP_MM) - side_px, close.y_px,
			      side_px, side_px };
}

struct rect page_view_listen_button(const struct page_view *view, const struct screen *screen)
{
	const struct rect close = page_view_close_button(view, screen),
			  widen = page_view_widen_button(view, screen);
	const int end_px = widen.width_px > 0 ? widen.x_px : close.x_px;

	if (!view->is_spoken)
		return (struct rect){ 0 };
	return (struct rect){ end_px - screen_px(screen, THEME_GAP_MM) - close.width_px, close.y_px,
			      close.width_px, close.height_px };
}

void page_view_offer_spoken(struct page_view *view, bool offered)
{
	view->head_dirty |= offered != view->is_spoken;
	view->is_spoken = offered;
}

void page_view_show_spoken(struct page_view *view, const struct overlay_spoken *spoken)
{
	view->head_dirty |= view->spoken.fade.on != (spoken != NULL);
	spoken_view_set(&view->spoken, spoken);
}

int page_view_scroll_most(const struct page_view *view, const struct screen *screen)
{
	int most_px = view->article ? article_layout_height_px(view->article) -
					      page_view_window(view, screen).height_px
				    : 0;

	return most_px > 0 ? most_px : 0;
}

/* ---- state ---- */

int page_view_open(struct page_view *view, const struct screen *screen, int part,
		   struct bytes bytes, const char *credits, const struct picture_source *pictures)
{
	struct article_layout_options options = { .theme = screen->theme,
						  .pictures = *pictures,
						  .credits = credits };
	struct article_layout *article;
	struct rect window;
	int rc;

	if (view->part < 0)
		view->wide = false;
	window = page_view_window(view, screen);
	options.width_px = window.width_px;
	options.view_px = window.height_px;
	rc = article_layout_create(&article, &options, bytes);
	if (rc < 0)
		return rc;
	article_layout_destroy(view->article);
	view->article = article;
	view->part = part;
	view->fade.on = true;
	view->is_spoken = false;
	spoken_view_set(&view->spoken, NULL);
	view->scroll = (struct scroll){ 0 };
	forget_strips(view);
	view->head_dirty = true;
	return 0;
}

void page_view_close(struct page_view *view)
{
	view->part = -1;
	view->fade.on = false;
	spoken_view_set(&view->spoken, NULL);
}

void page_view_drop(struct page_view *view)
{
	article_layout_destroy(view->article);
	view->article = NULL;
	view->fade = view->spoken.fade = (struct fade){ 0 };
	view->part = -1;
	view->wide = false;
}

bool page_view_widen(struct page_view *view, const struct screen *screen, bool on)
{
	on = on && view->part >= 0 && !screen->reach;
	if (on == view->wide)
		return false;
	view->wide = on;
	page_view_lay_out(view, screen);
	return true;
}

void page_view_lay_out(struct page_view *view, const struct screen *screen)
{
	struct rect window;
	float read, height_px, most_px;

	view->wide &= !screen->reach;
	view->head_dirty = true;
	if (!view->article)
		return;
	window = page_view_window(view, screen);
	read = view->scroll.px / (float)article_layout_height_px(view->article);
	if (article_layout_resize(view->article, window.width_px, window.height_px) < 0)
		page_view_close(view); /* no memory for the links */
	height_px = (float)article_layout_height_px(view->article);
	most_px = (float)page_view_scroll_most(view, screen);
	view->scroll = (struct scroll){ .px = fminf(read * height_px, most_px) };
	forget_strips(view);
}

void page_view_picture_arrived(struct page_view *view, const char *name)
{
	int from_px = view->article ? article_layout_picture_arrived(view->article, name) : -1;

	for (uint32_t i = 0; from_px >= 0 && i < PAGE_STRIPS; i++)
		if ((view->strips[i].index + 1) * view->strip_px > from_px)
			view->strips[i].stale = true;
}

float page_view_read(const struct page_view *view)
{
	return view->part >= 0 ? view->scroll.px / (float)article_layout_height_px(view->article)
			       : 0;
}

void page_view_read_from(struct page_view *view, const struct screen *screen, float share)
{
	if (view->part < 0)
		return;
	view->scroll.px_per_s = 0;
	view->scroll.px = fminf(share * (float)article_layout_height_px(view->article),
				(float)page_view_scroll_most(view, screen));
}

/* ---- touch ---- */

struct overlay_action page_view_tap(const struct page_view *view, const struct screen *screen,
				    float x_px, float y_px)
{
	struct overlay_action action = { .kind = OVERLAY_SWALLOWED, .part = view->part };
	struct rect window = page_view_window(view, screen);
	int picture;

	if (rect_holds(head_rect(view, screen), x_px, y_px)) {
		/* The whole right end of the head closes, so that a near miss closes too. */
		if (x_px >= (float)page_view_close_button(view, screen).x_px)
			action.kind = OVERLAY_CLOSE_PAGE;
		else if (rect_holds(page_view_widen_button(view, screen), x_px, y_px))
			action.kind = OVERLAY_WIDEN_PAGE;
		else if (rect_holds(page_view_listen_button(view, screen), x_px, y_px))
			action.kind = OVERLAY_LISTEN;
		return action;
	}
	if (!rect_holds(window, x_px, y_px))
		return action;
	x_px -= (float)window.x_px;
	y_px += view->scroll.px - (float)window.y_px;
	action.link = article_layout_link_at(view->article, x_px, y_px);
	picture = article_layout_picture_at(view->article, x_px, y_px);
	if (action.link)
		action.kind = OVERLAY_LINK;
	else if (picture >= 0)
		action = (struct overlay_action){ .kind = OVERLAY_PICTURE,
						  .part = view->part,
						  .picture = picture };
	return action;
}

/* ---- drawing ---- */

/* The control that begins the spoken text, or ends it: a line around words and a picture. */
static void draw_listen(cairo_t *context, const struct page_view *view, const struct screen *screen,
			struct rect listen)
{
	const struct theme *theme = screen->theme;
	const bool speaks = view->spoken.fade.on;
	/* Translators: buttons that begin and end a spoken text. */
	const char *text =
		speaks ? translate(theme->language, "Stop") : translate(theme->language, "Listen");
	const int icon_px = screen_px(screen, speaks ? 3.0f : 3.6f);
	PangoLayout *layout = theme_layout(theme, TEXT_BUTTON, text, -1);
	int label_px, text_px;
	double x;

	theme_limit_lines(layout, listen.width_px - 3 * icon_px, 1);
	pango_layout_get_pixel_size(layout, &label_px, &text_px);
	x = (listen.width_px - label_px - 2 * icon_px) / 2.0;
	theme_rounded(context, 0.5, 0.5, listen.width_px - 1, listen.height_px - 1,
		      (listen.height_px - 1) / 2.0);
	theme_set_source(context, theme_accent, 1);
	cairo_set_line_width(context, 1);
	cairo_stroke(context);
	cairo_move_to(context, x, (listen.height_px - text_px) / 2.0);
	pango_cairo_show_layout(context, layout);
	icon_draw(context, speaks ? ICON_STOP : ICON_LISTEN, x + label_px + 1.5 * icon_px,
		  listen.height_px / 2.0, icon_px);
	g_object_unref(layout);
}

/* The head of a page: the part's name in small type, a line, and the controls. */
static void draw_head(struct page_view *view, const struct screen *screen, const char *title)
{
	const struct rect head = head_rect(view, screen);
	const struct rect close = page_view_close_button(view, screen);
	const struct rect widen = page_view_widen_button(view, screen);
	const struct rect listen = page_view_listen_button(view, screen);
	const int left_px = screen_px(screen, MARGIN_MM);
	const int end_px = listen.width_px > 0  ? listen.x_px
			   : widen.width_px > 0 ? widen.x_px
						: close.x_px;
	const int room_px = end_px - head.x_px - left_px - screen_px(screen, THEME_GAP_MM);
	cairo_t *context = sprite_begin(&view->head, head.width_px, head.height_px);
	PangoLayout *layout;
	int text_px;

	if (!context)
		return;
	paper_draw_head(context, screen, head);
	layout = theme_layout(screen->theme, TEXT_BUTTON, title, -1);
	theme_limit_lines(layout, room_px > 1 ? room_px : 1, 1);
	pango_layout_get_pixel_size(layout, NULL, &text_px);
	theme_set_source(context, theme_ink_soft, 1);
	cairo_move_to(context, left_px, close.y_px - head.y_px + (close.height_px - text_px) / 2.0);
	pango_cairo_show_layout(context, layout);
	g_object_unref(layout);
	if (widen.width_px > 0)
		icon_draw(context, view->wide ? ICON_NARROW : ICON_WIDEN,
			  widen.x_px - head.x_px + widen.width_px / 2.0,
			  widen.y_px - head.y_px + widen.height_px / 2.0, screen_px(screen, 4.5f));
	if (listen.width_px > 0) {
		cairo_save(context);
		cairo_translate(context, listen.x_px - head.x_px, listen.y_px - head.y_px);
		draw_listen(context, view, screen, listen);
		cairo_restore(context);
	}
	sprite_end(&view->head, context);
}

static void draw_strip(struct page_view *view, const struct screen *screen,
		       struct page_view_strip *strip)
{
	cairo_t *context =
		sprite_begin(&strip->sprite, page_view_rect(view, screen).width_px, view->strip_px);

	if (!context)
		return;
	article_layout_draw(view->article, context, strip->index * view->strip_px, view->strip_px);
	sprite_end(&strip->sprite, context);
}

/* ---- a frame ---- */

static bool update_strips(struct page_view *view, const struct screen *screen, int64_t step_ms)
{
	const int window_px = page_view_window(view, screen).height_px;
	int first = (int)view->scroll.px / view->strip_px;
	/* One strip more than is visible, so that scrolling finds it drawn. */
	int last = ((int)view->scroll.px + window_px) / view->strip_px + 1;
	int end = article_layout_height_px(view->article) / view->strip_px;
	uint32_t budget = STRIPS_A_FRAME;
	bool moving = false;

	for (int index = first; index <= last && index <= end; index++) {
		struct page_view_strip *strip = &view->strips[index % PAGE_STRIPS];

		if (strip->index != index || strip->stale) {
			if (budget == 0) {
				moving = true;
				continue;
			}
			strip->index = index;
			strip->stale = false;
			strip->fade.on = true;
			if (view->fade.alpha < 1) /* it appears together with its page */
				strip->fade.alpha = 1;
			draw_strip(view, screen, strip);
			budget--;
		}
		moving |= fade_advance(&strip->fade, step_ms);
	}
	return moving;
}

bool page_view_update(struct page_view *view, const struct screen *screen, const char *title,
		      int64_t step_ms)
{
	bool moving;

	if (view->head_dirty && view->part >= 0)
		draw_head(view, screen, title);
	view->head_dirty = false;
	moving = fade_advance(&view->fade, step_ms * FADE_MS / PAGE_FADE_MS);
	moving |=
		spoken_view_update(&view->spoken, screen, page_view_window(view, screen), step_ms);
	moving |= scroll_advance(&view->scroll, page_view_scroll_most(view, screen), step_ms);
	if (!view->fade.on && view->fade.alpha == 0)
		page_view_drop(view);
	else if (view->article)
		moving |= update_strips(view, screen, step_ms);
	return moving;
}

void page_view_layers(const struct page_view *view, const struct screen *screen,
		      const struct paper *paper, struct layers *layers)
{
	const struct rect page = page_view_rect(view, screen);
	const struct rect window = page_view_window(view, screen);
	const struct paper_slide slide = paper_slide(screen, &view->fade);
	const float foot_px = (float)view->foot.bitmap.height_px;
	const int most_px = page_view_scroll_most(view, screen);

	if (!view->article)
		return;
	paper_add_ground(paper, layers, slide, page);
	for (uint32_t i = 0; i < PAGE_STRIPS; i++) {
		const struct page_view_strip *strip = &view->strips[i];
		const float top = (float)window.y_px - roundf(view->scroll.px) +
				  (float)(strip->index * view->strip_px);

		if (strip->index >= 0)
			layers_add_clipped(layers, &strip->sprite,
					   slide.alpha * fade_eased(&strip->fade), window, top,
					   slide.dx_px, slide.dy_px);
	}
	if (view->scroll.px < (float)most_px - 1)
		layers_add_stretched(
			layers, &view->foot, slide.alpha, (float)window.x_px + slide.dx_px,
			(float)(window.y_px + window.height_px) - foot_px + slide.dy_px,
			(float)window.width_px, foot_px);
	paper_add_mark(paper, layers, slide, window, view->scroll.px, most_px);
	paper_add_at(layers, &view->head, slide, paper_head(screen, page));
	spoken_view_layers(&view->spoken, screen, window, layers);
}
