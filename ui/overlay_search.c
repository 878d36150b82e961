/* The search: a field, a list of results and a keyboard. It stands where a page would. If half a
 * panel is too narrow for fingers on keys, it takes the whole width. */
#include <stdlib.h>
#include <string.h>

#include "ui/icon.h"
#include "ui/overlay_state.h"
#include "ui/translate.h"

#define SIDE_MM    4.0f   /* margin beside field and rows */
#define ROW_MM     18.0f  /* row of the list; higher on panels too tall for SEARCH_ROWS rows */
#define WIDTH_MM   100.0f /* minimum width of the keyboard, if the panel has it */
#define HEIGHT_MM  110.0f /* minimum height of the search in portrait */
#define KEEP_MM    30.0f  /* a strip of the model lower than this is not kept */
#define PADDING_MM 3.0f

enum { ROW_NONE = -1, ROW_NOTHING_FOUND = -2 };

static int px(const struct overlay *overlay, float mm)
{
	return theme_px(&overlay->theme, mm);
}

/* ---- layout ---- */

struct rect overlay_search_rect(const struct overlay *overlay)
{
	struct rect rect = overlay_half_rect(overlay), bar = overlay_chrome_rect(overlay);
	int bar_px = bar.y_px - px(overlay, THEME_GAP_MM);

	if (overlay_is_flat(overlay))
		return rect;
	if (overlay_is_portrait(overlay)) {
		if (rect.y_px > bar_px - px(overlay, HEIGHT_MM) && !overlay->comfort.reach)
			rect.y_px = bar_px - px(overlay, HEIGHT_MM);
		if (rect.y_px < px(overlay, KEEP_MM))
			rect.y_px = 0;
		rect.height_px = bar_px - rect.y_px;
	} else if (rect.width_px < px(overlay, WIDTH_MM)) {
		rect = (struct rect){ 0, 0, overlay->width_px, bar_px };
	} else if (bar.x_px + bar.width_px > rect.x_px) {
		rect.height_px = bar_px; /* with many languages the bar extends below it */
	}
	return rect;
}

static struct rect head_rect(const struct overlay *overlay)
{
	return overlay_head_rect(overlay, overlay_search_rect(overlay));
}

/* The place of list and keyboard: below the head, or on a flat panel above head and bar. */
static struct rect body_rect(const struct overlay *overlay)
{
	struct rect rect = overlay_search_rect(overlay), head = head_rect(overlay);

	if (overlay_is_flat(overlay)) {
		rect.height_px = head.y_px - rect.y_px;
		return rect;
	}
	rect.y_px += head.height_px;
	rect.height_px -= head.height_px;
	return rect;
}

/* Below the list, or on a flat panel beside it. */
struct rect overlay_keyboard_rect(const struct overlay *overlay)
{
	struct rect rect = body_rect(overlay);

	rect.y_px += rect.height_px - overlay->search.keyboard.height_px;
	rect.height_px = overlay->search.keyboard.height_px;
	if (overlay_is_flat(overlay))
		rect.width_px /= 2;
	return rect;
}

struct rect overlay_found_rect(const struct overlay *overlay)
{
	struct rect rect = body_rect(overlay);

	if (overlay_is_flat(overlay)) {
		rect.x_px = rect.width_px / 2;
		rect.width_px -= rect.x_px;
	} else {
		rect.height_px -= overlay->search.keyboard.height_px;
	}
	return rect;
}

static struct rect close_rect(const struct overlay *overlay)
{
	return overlay_close_in(overlay, head_rect(overlay));
}

static struct rect field_rect(const struct overlay *overlay)
{
	struct rect rect = close_rect(overlay);
	int left_px = head_rect(overlay).x_px + px(overlay, SIDE_MM);

	rect.width_px = rect.x_px - px(overlay, THEME_GAP_MM) - left_px;
	rect.x_px = left_px;
	return rect;
}

int overlay_found_row_px(const struct overlay *overlay)
{
	int row_px = theme_text_px(&overlay->theme, ROW_MM);
	int least_px = overlay_found_rect(overlay).height_px / (SEARCH_ROWS - 2);

	return row_px > least_px ? row_px : least_px;
}

static int row_count(const struct overlay *overlay)
{
	return overlay->search.found_count > 0 ? (int)overlay->search.found_count : 1;
}

int overlay_found_scroll_most(const struct overlay *overlay)
{
	int most_px = row_count(overlay) * overlay_found_row_px(overlay) -
		      overlay_found_rect(overlay).height_px;

	return most_px > 0 ? most_px : 0;
}

/* ---- state ---- */

static void lay_out_keyboard(struct overlay *overlay, bool latin)
{
	struct rect body = body_rect(overlay);
	struct keyboard *keyboard = &overlay->search.keyboard;

	if (overlay_is_flat(overlay))
		body.width_px /= 2;
	else
		body.height_px -= px(overlay, ROW_MM); /* at least one row stays visible */
	keyboard_layout(keyboard, &overlay->theme, overlay->theme.language, latin, body.width_px,
			body.height_px);
	overlay->search.keyboard_dirty = true;
	overlay->search.pressed = -1;
}

/* With nothing typed, all parts are listed in order of importance. */
static void list_all(struct overlay *overlay)
{
	for (uint32_t i = 0; i < overlay->part_count; i++)
		overlay->search.found[i] = i;
	overlay->search.found_count = overlay->part_count;
	overlay->search.scroll_px = overlay->search.scroll_px_per_s = 0;
}

static void redraw_rows(struct overlay *overlay)
{
	for (uint32_t i = 0; i < SEARCH_ROWS; i++)
		overlay->search.rows[i].stale = true;
}

void overlay_show_search(struct overlay *overlay, bool on)
{
	struct search *search = &overlay->search;

	if (on == search->fade.on || (on && overlay->part_count == 0))
		return;
	if (on) {
		search->query[0] = 0;
		overlay_search_again(overlay);
		return;
	}
	search->fade.on = false;
	overlay->chrome_dirty = overlay->callouts_dirty = true;
}

void overlay_search_again(struct overlay *overlay)
{
	struct search *search = &overlay->search;

	if (search->fade.on || overlay->part_count == 0)
		return;
	search->fade.on = true;
	overlay->chrome_dirty = overlay->callouts_dirty = true;
	overlay_close_page(overlay);
	overlay_show_card(overlay, -1);
	overlay_show_help(overlay, false);
	overlay_show_tours(overlay, false);
	search->head_dirty = true;
	for (uint32_t i = 0; i < SEARCH_ROWS; i++)
		search->rows[i] = (struct search_row){ .part = ROW_NONE };
	lay_out_keyboard(overlay, false);
	list_all(overlay);
}

bool overlay_searching(const struct overlay *overlay)
{
	return overlay->search.fade.on;
}

const char *overlay_query(const struct overlay *overlay)
{
	return overlay->search.query;
}

bool overlay_press(struct overlay *overlay, int key)
{
	struct search *search = &overlay->search;
	bool changed = false;

	if (key == OVERLAY_KEY_CLEAR) {
		changed = search->query[0] != 0;
		search->query[0] = 0;
	} else if (key >= 0 && key < (int)search->keyboard.key_count) {
		const struct keyboard_key *pressed = &search->keyboard.keys[key];

		search->pressed = key;
		search->press.alpha = 1;
		if (pressed->kind == KEY_LATIN)
			lay_out_keyboard(overlay, !search->keyboard.latin);
		else
			changed = keyboard_type(pressed, search->query, sizeof(search->query));
	}
	search->head_dirty |= changed;
	if (changed && !search->query[0])
		list_all(overlay);
	return changed;
}

void overlay_found(struct overlay *overlay, const uint32_t *parts, uint32_t count)
{
	struct search *search = &overlay->search;

	search->found_count = 0;
	for (uint32_t i = 0; i < count && search->found_count < overlay->part_count; i++)
		if (parts[i] < overlay->part_count)
			search->found[search->found_count++] = parts[i];
	search->scroll_px = search->scroll_px_per_s = 0;
}

int overlay_search_parts(struct overlay *overlay, uint32_t count)
{
	uint32_t *found = calloc((size_t)count + 1, sizeof(*found));

	if (!found)
		return -1;
	free(overlay->search.found);
	overlay->search.found = found;
	overlay->search.found_count = 0;
	return 0;
}

void overlay_search_language(struct overlay *overlay)
{
	overlay->search.head_dirty = true;
	redraw_rows(overlay);
	if (overlay->search.fade.on)
		lay_out_keyboard(overlay, false);
}

void overlay_search_picture(struct overlay *overlay, const char *name)
{
	for (uint32_t i = 0; i < SEARCH_ROWS; i++) {
		struct search_row *row = &overlay->search.rows[i];

		if (row->part >= 0 && row->part < (int)overlay->part_count &&
		    strcmp(overlay->parts[row->part].thumbnail, name) == 0)
			row->stale = true;
	}
}

/* ---- touch ---- */

struct overlay_action overlay_search_tap(const struct overlay *overlay, float x_px, float y_px)
{
	struct overlay_action action = { .kind = OVERLAY_SWALLOWED, .part = -1 };
	struct rect keys = overlay_keyboard_rect(overlay);
	struct rect list = overlay_found_rect(overlay), head = head_rect(overlay);
	struct rect field = field_rect(overlay);
	bool mirrored = theme_is_right_to_left(&overlay->theme);

	if (rect_holds(head, x_px, y_px)) {
		float from_end_px = mirrored ? x_px - (float)field.x_px
					     : (float)(field.x_px + field.width_px) - x_px;

		if (x_px >= (float)close_rect(overlay).x_px)
			action.kind = OVERLAY_SEARCH;
		else if (overlay->search.query[0] && from_end_px >= 0 &&
			 from_end_px < (float)head.height_px)
			action = (struct overlay_action){ .kind = OVERLAY_KEY,
							  .part = -1,
							  .key = OVERLAY_KEY_CLEAR };
	} else if (rect_holds(keys, x_px, y_px)) {
		action.key = keyboard_key_at(&overlay->search.keyboard, x_px - (float)keys.x_px,
					     y_px - (float)keys.y_px);
		if (action.key >= 0)
			action.kind = OVERLAY_KEY;
	} else if (rect_holds(list, x_px, y_px)) {
		int row = (int)((y_px - (float)list.y_px + overlay->search.scroll_px) /
				(float)overlay_found_row_px(overlay));

		if (row < (int)overlay->search.found_count) {
			action.kind = OVERLAY_FOUND;
			action.part = (int)overlay->search.found[row];
		}
	}
	return action;
}

/* ---- drawing ---- */

/* Draws the query with a caret behind it, or, while nothing is typed, what the field is for. */
static void draw_query(cairo_t *context, const struct overlay *overlay, int x_px, int width_px,
		       int height_px)
{
	const char *query = overlay->search.query;
	/* Translators: stands in the empty search field. */
	const char *text = *query ? query : translate(overlay->theme.language, "Search");
	PangoLayout *layout = theme_layout(&overlay->theme, TEXT_BODY, text, -1);
	bool mirrored = theme_is_right_to_left(&overlay->theme), from_right = mirrored;
	int text_px, tall_px, left_px, caret_px = px(overlay, 0.5f);

	if (*query)
		from_right = theme_begins_at_right(query);
	pango_layout_get_pixel_size(layout, &text_px, &tall_px);
	if (text_px > width_px) { /* the end is where the visitor types */
		pango_layout_set_width(layout, width_px * PANGO_SCALE);
		pango_layout_set_height(layout, -1);
		pango_layout_set_ellipsize(layout, PANGO_ELLIPSIZE_START);
		text_px = width_px;
	}
	left_px = mirrored ? x_px + width_px - text_px : x_px;
	theme_set_source(context, *query ? theme_ink : theme_ink_soft, 1);
	cairo_move_to(context, left_px, (height_px - tall_px) / 2.0);
	pango_cairo_show_layout(context, layout);
	g_object_unref(layout);
	if (!*query) /* the caret is before the placeholder */
		from_right = !from_right;
	cairo_rectangle(context, from_right ? left_px - 2 * caret_px : left_px + text_px + caret_px,
			(height_px - tall_px) / 2.0, caret_px, tall_px);
	theme_set_source(context, theme_accent, 1);
	cairo_fill(context);
}

static void draw_field(cairo_t *context, const struct overlay *overlay)
{
	struct rect rect = head_rect(overlay), field = field_rect(overlay);
	bool mirrored = theme_is_right_to_left(&overlay->theme);
	int icon_px = px(overlay, 4.0f), end_px = field.height_px;

	cairo_save(context);
	cairo_translate(context, field.x_px - rect.x_px, field.y_px - rect.y_px);
	theme_rounded(context, 0, 0, field.width_px, field.height_px, px(overlay, THEME_RADIUS_MM));
	theme_set_source(context, theme_paper_shade, 1);
	cairo_fill(context);
	theme_set_source(context, theme_ink_soft, 1);
	icon_draw(context, ICON_SEARCH, mirrored ? field.width_px - end_px / 2.0 : end_px / 2.0,
		  field.height_px / 2.0, icon_px);
	if (overlay->search.query[0])
		icon_draw(context, ICON_CLOSE,
			  mirrored ? end_px / 2.0 : field.width_px - end_px / 2.0,
			  field.height_px / 2.0, px(overlay, 2.8f));
	draw_query(context, overlay, end_px, field.width_px - 2 * end_px, field.height_px);
	cairo_restore(context);
}

void overlay_draw_search_head(struct overlay *overlay)
{
	struct rect rect = head_rect(overlay), close = close_rect(overlay);
	cairo_t *context =
		overlay_begin(overlay, BITMAP_SEARCH_HEAD, rect.width_px, rect.height_px);

	if (!context)
		return;
	theme_set_source(context, theme_paper, 1);
	cairo_paint(context);
	cairo_rectangle(context, 0, overlay_is_flat(overlay) ? 0 : rect.height_px - 1,
			rect.width_px, 1);
	theme_set_source(context, theme_line, 1);
	cairo_fill(context);
	draw_field(context, overlay);
	cairo_translate(context, close.x_px - rect.x_px, close.y_px - rect.y_px);
	overlay_draw_close(overlay, context, close.width_px, close.height_px);
	overlay_end(overlay, BITMAP_SEARCH_HEAD, context);
}

static void draw_thumbnail(cairo_t *context, const struct overlay *overlay, const char *name,
			   int x_px, int y_px, int side_px)
{
	struct overlay_picture found = { 0 };
	struct bitmap scaled;

	cairo_save(context);
	theme_rounded(context, x_px, y_px, side_px, side_px, px(overlay, 0.8f));
	cairo_clip(context);
	theme_set_source(context, theme_paper_shade, 1);
	cairo_paint(context);
	if (*name && overlay->pictures.get &&
	    overlay->pictures.get(overlay->pictures.data, name, &found) && found.picture &&
	    bitmap_from_picture(&scaled, found.picture, side_px, side_px) == 0) {
		cairo_set_source_surface(context, scaled.surface, x_px, y_px);
		cairo_paint(context);
		bitmap_finish(&scaled);
	}
	cairo_restore(context);
}

static void draw_part(cairo_t *context, const struct overlay *overlay, const struct part *part,
		      int width_px, int height_px)
{
	int side_px = px(overlay, SIDE_MM), gap_px = px(overlay, 1.5f);
	int picture_px = height_px - 2 * gap_px, padding_px = px(overlay, PADDING_MM);
	int text_px = width_px - 2 * side_px - picture_px - padding_px;
	int x_px = side_px + picture_px + padding_px, picture_x_px = side_px;
	int title_px, caption_px, y_px;

	if (theme_is_right_to_left(&overlay->theme)) {
		x_px = side_px;
		picture_x_px = width_px - side_px - picture_px;
	}
	draw_thumbnail(context, overlay, part->thumbnail, picture_x_px, gap_px, picture_px);
	title_px = theme_line_px(&overlay->theme, TEXT_BODY, part->title);
	caption_px = theme_line_px(&overlay->theme, TEXT_FIGURE, part->caption);
	y_px = (height_px - title_px - (*part->caption ? caption_px : 0)) / 2;
	theme_show_line(context, &overlay->theme, TEXT_BODY, theme_ink, part->title, x_px, y_px,
			text_px);
	theme_show_line(context, &overlay->theme, TEXT_FIGURE, theme_ink_soft, part->caption, x_px,
			y_px + title_px, text_px);
	cairo_rectangle(context, side_px, height_px - 1, width_px - 2 * side_px, 1);
	theme_set_source(context, theme_line, 1);
	cairo_fill(context);
}

static void draw_row(struct overlay *overlay, uint32_t slot)
{
	const struct search_row *row = &overlay->search.rows[slot];
	enum bitmap_id id = (enum bitmap_id)(BITMAP_ROW + slot);
	int width_px = overlay_found_rect(overlay).width_px;
	int height_px = overlay_found_row_px(overlay);
	cairo_t *context = overlay_begin(overlay, id, width_px, height_px);

	if (!context)
		return;
	theme_set_source(context, theme_paper, 1);
	cairo_paint(context);
	if (row->part >= 0)
		draw_part(context, overlay, &overlay->parts[row->part], width_px, height_px);
	else
		theme_show_line(context, &overlay->theme, TEXT_BODY, theme_ink_soft,
				translate(overlay->theme.language, "No results"),
				px(overlay, SIDE_MM + PADDING_MM), px(overlay, 5.0f),
				width_px - 2 * px(overlay, SIDE_MM + PADDING_MM));
	overlay_end(overlay, id, context);
}

/* ---- a frame ---- */

static bool update_rows(struct overlay *overlay, int64_t step_ms)
{
	struct search *search = &overlay->search;
	int row_px = overlay_found_row_px(overlay), first = (int)search->scroll_px / row_px;
	int last = ((int)search->scroll_px + overlay_found_rect(overlay).height_px) / row_px;
	uint32_t budget = SEARCH_ROWS_A_FRAME;
	bool moving = false;

	for (int i = first; i <= last && i < row_count(overlay); i++) {
		uint32_t slot = (uint32_t)i % SEARCH_ROWS;
		struct search_row *row = &search->rows[slot];
		int part = search->found_count > 0 ? (int)search->found[i] : ROW_NOTHING_FOUND;

		if (row->part != part || row->index != i || row->stale) {
			if (budget == 0) {
				row->fade.alpha =
					row->stale && row->part == part ? row->fade.alpha : 0;
				moving = true;
				continue;
			}
			budget--;
			if (row->part != part)
				row->fade.alpha = 0; /* fades in again */
			row->part = part;
			row->index = i;
			row->stale = false;
			row->fade.on = true;
			draw_row(overlay, slot);
		}
		moving |= fade_advance(&row->fade, step_ms);
	}
	return moving;
}

bool overlay_update_search(struct overlay *overlay, int64_t step_ms)
{
	struct search *search = &overlay->search;
	bool moving = fade_advance(&search->fade, step_ms);

	if (search->fade.alpha == 0 && !search->fade.on)
		return moving;
	moving |= fade_advance(&search->press, step_ms);
	if (search->keyboard_dirty)
		overlay_draw_keyboard(overlay);
	if (search->head_dirty)
		overlay_draw_search_head(overlay);
	search->keyboard_dirty = search->head_dirty = false;
	return search->fade.on ? update_rows(overlay, step_ms) || moving : moving;
}

/* Sets the place of the key that was pressed last. Returns false if there is none. */
bool overlay_pressed_rect(const struct overlay *overlay, struct rect *out)
{
	struct rect keys = overlay_keyboard_rect(overlay);
	const struct keyboard_key *key;

	if (overlay->search.pressed < 0)
		return false;
	key = &overlay->search.keyboard.keys[overlay->search.pressed];
	*out = (struct rect){ keys.x_px + key->x_px, keys.y_px + key->y_px, key->width_px,
			      key->height_px };
	return true;
}
