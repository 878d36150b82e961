/* Turns what is shown into a list of textured quads, and paints that list with Cairo for tests. */
#include <math.h>
#include <string.h>

#include "ui/hint.h"
#include "ui/overlay_state.h"

#define DIM 0.6f /* share of its alpha that a callout loses while its part is hidden */

struct list {
	const struct overlay *overlay;
	struct layers layers;
};

/* Slows down at the end, so that nothing stops abruptly. */
static float ease(float alpha)
{
	return alpha * (2 - alpha);
}

static struct overlay_layer *add(struct list *list, int id, float alpha)
{
	return layers_add(&list->layers, &list->overlay->sprites[id], alpha);
}

static void add_rect(struct list *list, int id, float alpha, float x, float y, float width,
		     float height)
{
	layers_add_stretched(&list->layers, &list->overlay->sprites[id], alpha, x, y, width,
			     height);
}

static void add_bitmap(struct list *list, int id, float alpha, float x, float y)
{
	layers_add_at(&list->layers, &list->overlay->sprites[id], alpha, x, y);
}

static float label_alpha(const struct label *label)
{
	return ease(label->fade.alpha) * (1 - DIM * ease(label->dim.alpha));
}

static void add_leader(struct list *list, const struct label *label)
{
	const struct callout *c = &label->place;
	float dx = c->anchor_x_px - c->port_x_px, dy = c->anchor_y_px - c->port_y_px;
	float length = hypotf(dx, dy);
	float half = (float)list->overlay->sprites[BITMAP_LEADER].bitmap.height_px / 2;
	struct overlay_layer *layer;
	float nx, ny;

	if (length < 1)
		return;
	layer = add(list, BITMAP_LEADER, label_alpha(label));
	if (!layer)
		return;
	nx = dy / length * half;
	ny = -dx / length * half;
	layer->corners_px[0][0] = c->port_x_px + nx;
	layer->corners_px[0][1] = c->port_y_px + ny;
	layer->corners_px[1][0] = c->anchor_x_px + nx;
	layer->corners_px[1][1] = c->anchor_y_px + ny;
	layer->corners_px[2][0] = c->anchor_x_px - nx;
	layer->corners_px[2][1] = c->anchor_y_px - ny;
	layer->corners_px[3][0] = c->port_x_px - nx;
	layer->corners_px[3][1] = c->port_y_px - ny;
}

static void add_callouts(struct list *list)
{
	const struct overlay *overlay = list->overlay;
	float half = (float)overlay->sprites[BITMAP_DOT].bitmap.width_px / 2;

	for (uint32_t i = 0; i < LABELS; i++)
		if (overlay->labels[i].drawn)
			add_leader(list, &overlay->labels[i]);
	for (uint32_t i = 0; i < LABELS; i++) {
		const struct label *label = &overlay->labels[i];

		if (label->drawn)
			add_bitmap(list, BITMAP_DOT, label_alpha(label),
				   label->place.anchor_x_px - half,
				   label->place.anchor_y_px - half);
	}
	for (uint32_t i = 0; i < LABELS; i++) {
		const struct label *label = &overlay->labels[i];

		if (label->drawn)
			add_bitmap(list, BITMAP_LABEL + (int)i, label_alpha(label),
				   (float)label->place.x_px, (float)label->place.y_px);
	}
}

static void add_clipped(struct list *list, int id, float alpha, struct rect view, float top,
			float dx, float dy)
{
	layers_add_clipped(&list->layers, &list->overlay->sprites[id], alpha, view, top, dx, dy);
}

static void add_strip(struct list *list, uint32_t slot, struct rect view, float dx, float dy)
{
	const struct overlay *overlay = list->overlay;
	const struct strip *strip = &overlay->strips[slot];
	float top = (float)view.y_px - roundf(overlay->scroll_px) +
		    (float)(strip->index * overlay->strip_px);

	if (strip->index >= 0)
		add_clipped(list, BITMAP_STRIP + (int)slot,
			    ease(overlay->page.alpha) * ease(strip->fade.alpha), view, top, dx, dy);
}

static void add_scroll_mark(struct list *list, struct rect view, float scroll_px, float most,
			    float alpha, float dx, float dy)
{
	const struct overlay *overlay = list->overlay;
	float width = (float)overlay->sprites[BITMAP_SCROLL].bitmap.width_px, height;

	if (most <= 0)
		return;
	height = (float)view.height_px * (float)view.height_px / ((float)view.height_px + most);
	add_rect(list, BITMAP_SCROLL, alpha, (float)(view.x_px + view.width_px) - 2 * width + dx,
		 (float)view.y_px + scroll_px / most * ((float)view.height_px - height) + dy, width,
		 height);
}

static void add_page(struct list *list)
{
	const struct overlay *overlay = list->overlay;
	struct rect page = overlay_page_rect(overlay), view = overlay_view_rect(overlay);
	struct rect head = overlay_head_rect(overlay, page);
	float alpha = ease(overlay->page.alpha),
	      slide = (1 - alpha) * 12 * overlay->theme.px_per_mm;
	float dx = overlay_is_portrait(overlay) || overlay_is_flat(overlay) ? 0 : slide,
	      dy = slide - dx;
	float foot_px = (float)overlay->sprites[BITMAP_PAGE_FOOT].bitmap.height_px;

	if (!overlay->article)
		return;
	add_rect(list, BITMAP_PAPER, alpha, (float)page.x_px + dx, (float)page.y_px + dy,
		 (float)page.width_px, (float)page.height_px);
	for (uint32_t slot = 0; slot < STRIPS; slot++)
		add_strip(list, slot, view, dx, dy);
	if (overlay->scroll_px < (float)overlay_scroll_most(overlay) - 1)
		add_rect(list, BITMAP_PAGE_FOOT, alpha, (float)view.x_px + dx,
			 (float)(view.y_px + view.height_px) - foot_px + dy, (float)view.width_px,
			 foot_px);
	add_scroll_mark(list, view, overlay->scroll_px, (float)overlay_scroll_most(overlay), alpha,
			dx, dy);
	add_bitmap(list, BITMAP_PAGE_HEAD, alpha, (float)head.x_px + dx, (float)head.y_px + dy);
}

static void add_row(struct list *list, uint32_t slot, struct rect view, float alpha, float dx,
		    float dy)
{
	const struct overlay *overlay = list->overlay;
	const struct search_row *row = &overlay->search.rows[slot];
	int count = overlay->search.found_count > 0 ? (int)overlay->search.found_count : 1;
	float top = (float)view.y_px - roundf(overlay->search.scroll_px) +
		    (float)(row->index * overlay_found_row_px(overlay));

	if (row->fade.on && row->index < count)
		add_clipped(list, BITMAP_ROW + (int)slot, alpha * ease(row->fade.alpha), view, top,
			    dx, dy);
}

static void add_search(struct list *list)
{
	const struct overlay *overlay = list->overlay;
	struct rect all = overlay_search_rect(overlay), rows = overlay_found_rect(overlay);
	struct rect head = overlay_head_rect(overlay, all);
	struct rect keys = overlay_keyboard_rect(overlay), key;
	float alpha = ease(overlay->search.fade.alpha);
	float slide = (1 - alpha) * 12 * overlay->theme.px_per_mm;
	float dx = overlay_is_portrait(overlay) || overlay_is_flat(overlay) ? 0 : slide,
	      dy = slide - dx;

	add_rect(list, BITMAP_PAPER, alpha, (float)all.x_px + dx, (float)all.y_px + dy,
		 (float)all.width_px, (float)all.height_px);
	for (uint32_t slot = 0; slot < SEARCH_ROWS; slot++)
		add_row(list, slot, rows, alpha, dx, dy);
	add_scroll_mark(list, rows, overlay->search.scroll_px,
			(float)overlay_found_scroll_most(overlay), alpha, dx, dy);
	add_bitmap(list, BITMAP_SEARCH_HEAD, alpha, (float)head.x_px + dx, (float)head.y_px + dy);
	add_bitmap(list, BITMAP_KEYBOARD, alpha, (float)keys.x_px + dx, (float)keys.y_px + dy);
	if (overlay_pressed_rect(overlay, &key))
		add_rect(list, BITMAP_KEY, alpha * 0.35f * overlay->search.press.alpha,
			 (float)key.x_px + dx, (float)key.y_px + dy, (float)key.width_px,
			 (float)key.height_px);
}

static void add_gallery(struct list *list)
{
	const struct overlay *overlay = list->overlay;
	const struct gallery *gallery = &overlay->gallery;
	struct rect view = overlay_gallery_rect(overlay);
	float alpha = ease(gallery->fade.alpha);

	add_rect(list, BITMAP_NIGHT, alpha, 0, 0, (float)overlay->width_px,
		 (float)overlay->height_px);
	for (int picture = gallery->at - 1; picture <= gallery->at + 1; picture++) {
		float place[4];

		if (picture < 0 || picture >= gallery->count ||
		    !overlay_gallery_place(overlay, picture, place) ||
		    place[0] >= (float)overlay->width_px || place[0] + place[2] <= 0)
			continue;
		add_rect(list, BITMAP_PICTURE + picture % GALLERY_SLOTS,
			 alpha * ease(gallery->slots[picture % GALLERY_SLOTS].fade.alpha), place[0],
			 place[1], place[2], place[3]);
	}
	if (gallery->zoom == 1)
		add_bitmap(list, BITMAP_PICTURE_WORDS, alpha, (float)view.x_px,
			   (float)(view.y_px + view.height_px) + 2 * overlay->theme.px_per_mm);
	for (int button = 0; button < GALLERY_BUTTONS; button++) {
		struct rect rect = overlay_gallery_button(overlay, (enum gallery_button)button);

		if ((button == GALLERY_BACK && gallery->at == 0) ||
		    (button == GALLERY_ON && gallery->at + 1 >= gallery->count))
			continue;
		add_bitmap(list, BITMAP_PICTURE_BUTTON + button, alpha, (float)rect.x_px,
			   (float)rect.y_px);
	}
}

static void add_help(struct list *list)
{
	const struct overlay *overlay = list->overlay;
	const struct bitmap *finger = &overlay->sprites[BITMAP_FINGER].bitmap;
	struct rect help = overlay_help_rect(overlay);
	float alpha = ease(overlay->help.alpha), middles_px[HINT_FINGERS][2];

	add_bitmap(list, BITMAP_HELP, alpha, (float)help.x_px, (float)help.y_px);
	hint_fingers(&overlay->theme, help.width_px, overlay->part_count > 0, overlay->help_ms,
		     middles_px);
	for (int i = 0; i < HINT_FINGERS; i++)
		add_bitmap(list, BITMAP_FINGER, alpha,
			   (float)help.x_px + middles_px[i][0] - (float)finger->width_px / 2,
			   (float)help.y_px + middles_px[i][1] - (float)finger->height_px / 2);
}

static void add_turned(struct list *list, int id, float alpha, const float at[2],
		       const float along[2], float half_across, float half_along)
{
	layers_add_turned(&list->layers, &list->overlay->sprites[id], alpha, at, along, half_across,
			  half_along);
}

static void add_tools(struct list *list)
{
	const struct overlay *overlay = list->overlay;
	const float knob = (float)overlay->sprites[BITMAP_KNOB].bitmap.width_px / 2;
	const float upright[2] = { 0, -1 };
	float alpha[OVERLAY_TOOL_COUNT];
	struct overlay_knobs knobs;

	overlay_tool_knobs(overlay, &knobs);
	for (int tool = 0; tool < OVERLAY_TOOL_COUNT; tool++) {
		const struct rect rect = overlay_tool_rect(overlay, tool);

		alpha[tool] = ease(overlay->tools.fade[tool].alpha);
		if (alpha[tool] > 0)
			add_bitmap(list, BITMAP_DISC + tool, alpha[tool], (float)rect.x_px,
				   (float)rect.y_px);
	}
	if (alpha[0] > 0)
		add_turned(list, BITMAP_KNOB, alpha[0], knobs.light, upright, knob, knob);
	if (alpha[1] <= 0)
		return;
	add_turned(list, BITMAP_CUT, alpha[1], knobs.push, knobs.along, knobs.line_px,
		   knobs.thick_px);
	add_turned(list, BITMAP_KNOB, alpha[1], knobs.turn, upright, knob, knob);
	add_turned(list, BITMAP_PUSH, alpha[1], knobs.push, knobs.along, knob, knob);
}

uint32_t overlay_layers(const struct overlay *overlay, struct overlay_layer *layers, uint32_t most)
{
	struct list list = { .overlay = overlay, .layers = { .list = layers, .most = most } };
	const struct screen screen = overlay_screen(overlay);
	struct rect card = overlay_card_rect(overlay);
	struct rect chrome = overlay_chrome_rect(overlay);
	struct rect invitation = overlay_invitation_rect(overlay);
	struct rect question = overlay_question_rect(overlay);
	struct rect tour = overlay_tour_rect(overlay), menu = overlay_menu_rect(overlay);

	add_callouts(&list);
	add_tools(&list);
	add_help(&list);
	add_bitmap(&list, BITMAP_INVITATION, ease(overlay->invitation.alpha),
		   (float)invitation.x_px, (float)invitation.y_px);
	add_bitmap(&list, BITMAP_TOUR, ease(overlay->tour.fade.alpha), (float)tour.x_px,
		   (float)tour.y_px);
	add_bitmap(&list, BITMAP_TOURS, ease(overlay->tours.fade.alpha), (float)menu.x_px,
		   (float)menu.y_px);
	add_page(&list);
	add_bitmap(&list, BITMAP_CARD, ease(overlay->card.alpha), (float)card.x_px,
		   (float)card.y_px);
	if (overlay->search.fade.alpha > 0)
		add_search(&list);
	if (overlay->gallery.fade.alpha > 0)
		add_gallery(&list);
	languages_view_layers(&overlay->languages_view, &screen, &overlay->languages, &list.layers);
	add_bitmap(&list, BITMAP_CHROME, 1, (float)chrome.x_px, (float)chrome.y_px);
	add_bitmap(&list, BITMAP_QUESTION, ease(overlay->question.alpha), (float)question.x_px,
		   (float)question.y_px);
	return list.layers.count;
}

void overlay_paint(const struct overlay *overlay, cairo_t *context)
{
	struct overlay_layer list[OVERLAY_LAYERS_MAX];
	const struct layers layers = { .list = list,
				       .count = overlay_layers(overlay, list, OVERLAY_LAYERS_MAX) };

	layers_paint(&layers, context);
}
