/* Draws the overlay's bitmaps. If memory runs out for one, it is left out of the layers. */
#include <math.h>
#include <string.h>

#include "ui/hint.h"
#include "ui/icon.h"
#include "ui/overlay_state.h"
#include "ui/prompt.h"
#include "ui/translate.h"

static int px(const struct overlay *overlay, float mm)
{
	return theme_px(&overlay->theme, mm);
}

cairo_t *overlay_begin(struct overlay *overlay, enum bitmap_id id, int width_px, int height_px)
{
	return sprite_begin(&overlay->sprites[id], width_px, height_px);
}

void overlay_end(struct overlay *overlay, enum bitmap_id id, cairo_t *context)
{
	sprite_end(&overlay->sprites[id], context);
}

static void put(struct overlay *overlay, enum bitmap_id id, const struct bitmap *fresh, int rc)
{
	sprite_take(&overlay->sprites[id], fresh, rc);
}

/* A leader in cross-section: a light core between dark edges, so that it shows on any material. */
static void draw_leader(struct overlay *overlay)
{
	int across_px = px(overlay, 1.5f) + 2;
	cairo_t *context = overlay_begin(overlay, BITMAP_LEADER, 4, across_px);

	if (!context)
		return;
	cairo_rectangle(context, 0, 1, 4, across_px - 2);
	theme_set_source(context, theme_night, 0.72);
	cairo_fill(context);
	cairo_rectangle(context, 0, across_px * 0.34, 4, across_px * 0.32);
	theme_set_source(context, theme_night_text, 1);
	cairo_fill(context);
	overlay_end(overlay, BITMAP_LEADER, context);
}

static void draw_dot(struct overlay *overlay)
{
	int side_px = px(overlay, 3.2f);
	double middle = side_px / 2.0, turn = 4 * acos(0.0);
	cairo_t *context = overlay_begin(overlay, BITMAP_DOT, side_px, side_px);

	if (!context)
		return;
	cairo_arc(context, middle, middle, middle * 0.95, 0, turn);
	theme_set_source(context, theme_night, 0.72);
	cairo_fill(context);
	cairo_arc(context, middle, middle, middle * 0.72, 0, turn);
	theme_set_source(context, theme_night_text, 1);
	cairo_fill(context);
	cairo_arc(context, middle, middle, middle * 0.42, 0, turn);
	theme_set_source(context, theme_accent, 1);
	cairo_fill(context);
	overlay_end(overlay, BITMAP_DOT, context);
}

static void draw_foot(struct overlay *overlay)
{
	int height_px = px(overlay, 8.0f);
	cairo_t *context = overlay_begin(overlay, BITMAP_PAGE_FOOT, 4, height_px);
	cairo_pattern_t *gradient;

	if (!context)
		return;
	gradient = cairo_pattern_create_linear(0, 0, 0, height_px);
	cairo_pattern_add_color_stop_rgba(gradient, 0, theme_paper.red, theme_paper.green,
					  theme_paper.blue, 0);
	cairo_pattern_add_color_stop_rgba(gradient, 1, theme_paper.red, theme_paper.green,
					  theme_paper.blue, 1);
	cairo_set_source(context, gradient);
	cairo_paint(context);
	cairo_pattern_destroy(gradient);
	overlay_end(overlay, BITMAP_PAGE_FOOT, context);
}

void overlay_draw_fixed(struct overlay *overlay)
{
	struct bitmap finger;
	cairo_t *context;
	int width_px = px(overlay, 1.0f);

	draw_leader(overlay);
	draw_dot(overlay);
	draw_foot(overlay);
	context = overlay_begin(overlay, BITMAP_PAPER, 4, 4);
	if (context) {
		theme_set_source(context, theme_paper, 1);
		cairo_paint(context);
		overlay_end(overlay, BITMAP_PAPER, context);
	}
	context = overlay_begin(overlay, BITMAP_KEY, 4, 4);
	if (context) {
		theme_set_source(context, theme_accent, 1);
		cairo_paint(context);
		overlay_end(overlay, BITMAP_KEY, context);
	}
	context = overlay_begin(overlay, BITMAP_NIGHT, 4, 4);
	if (context) {
		theme_set_source(context, theme_night, 1);
		cairo_paint(context);
		overlay_end(overlay, BITMAP_NIGHT, context);
	}
	overlay_draw_gallery_buttons(overlay);
	put(overlay, BITMAP_FINGER, &finger, hint_draw_finger(&finger, &overlay->theme));
	context = overlay_begin(overlay, BITMAP_SCROLL, width_px, 4 * width_px);
	if (context) {
		theme_rounded(context, 0, 0, width_px, 4 * width_px, width_px / 2.0);
		theme_set_source(context, theme_ink_soft, 0.6);
		cairo_fill(context);
		overlay_end(overlay, BITMAP_SCROLL, context);
	}
}

void overlay_draw_chrome(struct overlay *overlay)
{
	struct bitmap fresh;
	const struct chrome_state state = {
		.language = overlay->languages.current,
		.back = overlay->back,
		.help = overlay->help.on,
		.search = overlay->search.fade.on,
		.tours = overlay->tours.fade.on || overlay->tour.on,
		.large = overlay->comfort.large,
		.reach = overlay->comfort.reach,
		.light = overlay->tools.now.on & OVERLAY_TOOL_LIGHT,
		.section = overlay->tools.now.on & OVERLAY_TOOL_SECTION,
		.languages = overlay->languages_view.fade.on,
	};
	int rc = chrome_draw(&fresh, &overlay->chrome, &overlay->theme,
			     (const char *const *)overlay->languages.codes, state);

	put(overlay, BITMAP_CHROME, &fresh, rc);
}

void overlay_draw_keyboard(struct overlay *overlay)
{
	struct bitmap fresh;

	put(overlay, BITMAP_KEYBOARD, &fresh,
	    keyboard_draw(&fresh, &overlay->search.keyboard, &overlay->theme));
}

void overlay_draw_help(struct overlay *overlay)
{
	struct bitmap fresh;
	int most_px = overlay_scene_rect(overlay).width_px - 2 * px(overlay, THEME_GAP_MM);

	put(overlay, BITMAP_HELP, &fresh,
	    hint_draw(&fresh, &overlay->theme, most_px, overlay->part_count > 0));
}

void overlay_draw_invitation(struct overlay *overlay)
{
	struct bitmap fresh;
	int most_px = overlay->width_px - 2 * px(overlay, THEME_GAP_MM);

	put(overlay, BITMAP_INVITATION, &fresh,
	    prompt_draw_invitation(&fresh, &overlay->theme,
				   (const char *const *)overlay->languages.codes,
				   overlay->languages.count, most_px));
}

void overlay_draw_question(struct overlay *overlay)
{
	struct bitmap fresh;
	int most_px = overlay->width_px - 2 * px(overlay, THEME_GAP_MM);

	put(overlay, BITMAP_QUESTION, &fresh,
	    prompt_draw_question(&fresh, &overlay->theme, overlay->question_s, most_px));
	overlay->question_drawn_s = overlay->question_s;
}

void overlay_draw_card(struct overlay *overlay)
{
	const struct part *part = &overlay->parts[overlay->card_shown];
	struct rect rect = overlay_card_rect(overlay);
	struct overlay_picture found = { 0 };
	struct card card = { .title = part->title,
			     .caption = part->caption,
			     .has_page = part->has_page };
	struct bitmap fresh;

	card.has_thumbnail = *part->thumbnail && overlay->pictures.get &&
			     overlay->pictures.get(overlay->pictures.data, part->thumbnail, &found);
	card.thumbnail = card.has_thumbnail ? found.picture : NULL;
	put(overlay, BITMAP_CARD, &fresh,
	    card_draw(&fresh, &overlay->theme, &card, rect.width_px, rect.height_px));
}

void overlay_draw_close(const struct overlay *overlay, cairo_t *context, int width_px,
			int height_px)
{
	/* Translators: a button that closes a page, a picture or the search. */
	const char *text = translate(overlay->theme.language, "Close");
	PangoLayout *layout = theme_layout(&overlay->theme, TEXT_BUTTON, text, -1);
	int label_px, text_px, cross_px = px(overlay, 3.0f);
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

/* The head of a page: the part's name in small type, a line, and the control that closes. */
void overlay_draw_page_head(struct overlay *overlay)
{
	struct rect head = overlay_head_rect(overlay, overlay_page_rect(overlay));
	struct rect close = overlay_close_rect(overlay);
	int text_px;
	int left_px = px(overlay, 8.0f);
	const struct rect widen = overlay_widen_rect(overlay);
	const int end_px = widen.width_px > 0 ? widen.x_px : close.x_px;
	int room_px = end_px - head.x_px - left_px - px(overlay, THEME_GAP_MM);
	cairo_t *context = overlay_begin(overlay, BITMAP_PAGE_HEAD, head.width_px, head.height_px);
	PangoLayout *layout;

	if (!context)
		return;
	theme_set_source(context, theme_paper, 1);
	cairo_paint(context);
	cairo_rectangle(context, 0, overlay_is_flat(overlay) ? 0 : head.height_px - 1,
			head.width_px, 1);
	theme_set_source(context, theme_line, 1);
	cairo_fill(context);

	layout = theme_layout(&overlay->theme, TEXT_BUTTON,
			      overlay->parts[overlay->page_titled].title, -1);
	theme_limit_lines(layout, room_px > 1 ? room_px : 1, 1);
	pango_layout_get_pixel_size(layout, NULL, &text_px);
	theme_set_source(context, theme_ink_soft, 1);
	cairo_move_to(context, left_px, close.y_px - head.y_px + (close.height_px - text_px) / 2.0);
	pango_cairo_show_layout(context, layout);
	g_object_unref(layout);

	if (widen.width_px > 0)
		icon_draw(context, overlay->page_wide ? ICON_NARROW : ICON_WIDEN,
			  widen.x_px - head.x_px + widen.width_px / 2.0,
			  widen.y_px - head.y_px + widen.height_px / 2.0, px(overlay, 4.5f));
	cairo_translate(context, close.x_px - head.x_px, close.y_px - head.y_px);
	overlay_draw_close(overlay, context, close.width_px, close.height_px);
	overlay_end(overlay, BITMAP_PAGE_HEAD, context);
}

void overlay_measure_labels(struct overlay *overlay)
{
	overlay->column_px = 0;
	for (uint32_t i = 0; i < overlay->part_count; i++) {
		struct part *part = &overlay->parts[i];

		part->label_px = overlay_measure_label(overlay, part->title);
		if (part->label_px > overlay->column_px)
			overlay->column_px = part->label_px;
	}
}

int overlay_measure_label(const struct overlay *overlay, const char *title)
{
	PangoLayout *layout = theme_layout(&overlay->theme, TEXT_LABEL, title, -1);
	int width_px;

	pango_layout_get_pixel_size(layout, &width_px, NULL);
	g_object_unref(layout);
	return width_px + 2 * px(overlay, 2.2f);
}

void overlay_draw_label(struct overlay *overlay, uint32_t index)
{
	struct label *label = &overlay->labels[index];
	bool selected = label->part == overlay->card_part || label->part == overlay->page_part;
	int width_px = label->place.width_px, height_px = overlay_row_px(overlay), text_px;
	int padding_px = px(overlay, 2.2f), inset_px = px(overlay, 0.6f);
	enum bitmap_id id = (enum bitmap_id)(BITMAP_LABEL + index);
	cairo_t *context = overlay_begin(overlay, id, width_px, height_px);
	PangoLayout *layout;

	label->drawn = true;
	label->drawn_selected = selected;
	if (!context)
		return;
	theme_rounded(context, 0, inset_px, width_px, height_px - 2 * inset_px,
		      px(overlay, THEME_RADIUS_MM));
	if (selected)
		theme_set_source(context, theme_accent, THEME_CHOSEN_ALPHA);
	else
		theme_set_source(context, theme_night, THEME_LABEL_ALPHA);
	cairo_fill(context);
	layout = theme_layout(&overlay->theme, TEXT_LABEL, overlay->parts[label->part].title, -1);
	/* One pixel more, so that rounding does not cut a text that fits. */
	theme_limit_lines(layout, width_px - 2 * padding_px + 1, 1);
	pango_layout_get_pixel_size(layout, NULL, &text_px);
	theme_set_source(context, theme_night_text, 1);
	cairo_move_to(context, padding_px, (height_px - text_px) / 2.0);
	pango_cairo_show_layout(context, layout);
	g_object_unref(layout);
	overlay_end(overlay, id, context);
}

void overlay_draw_strip(struct overlay *overlay, uint32_t slot)
{
	enum bitmap_id id = (enum bitmap_id)(BITMAP_STRIP + slot);
	int width_px = overlay_page_rect(overlay).width_px;
	cairo_t *context = overlay_begin(overlay, id, width_px, overlay->strip_px);

	if (!context)
		return;
	article_draw(overlay->article, context, overlay->strips[slot].index * overlay->strip_px,
		     overlay->strip_px);
	overlay_end(overlay, id, context);
}
