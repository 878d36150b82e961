/* Lays out field, list and keyboard, keeps the query, and draws the rows as they come into view. */
#include "ui/search_view.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "ui/icon.h"
#include "ui/translate.h"

#define SIDE_MM    4.0f   /* margin beside field and rows */
#define ROW_MM     18.0f  /* row of the list; higher on panels too tall for SEARCH_ROWS rows */
#define WIDTH_MM   100.0f /* minimum width of the keyboard, if the panel has it */
#define HEIGHT_MM  110.0f /* minimum height of the search in portrait */
#define KEEP_MM    30.0f  /* a strip of the model lower than this is not kept */
#define PADDING_MM 3.0f
#define PRESS      0.35f /* alpha of the highlight over a pressed key */

enum { ROW_NONE = -1, ROW_NOTHING_FOUND = -2, ROWS_A_FRAME = 2 };

void search_view_init(struct search_view *view, uint32_t *next_id)
{
	*view = (struct search_view){ .pressed = -1 };
	for (uint32_t i = 0; i < SEARCH_ROWS; i++)
		sprites_init(&view->rows[i].sprite, 1, next_id);
	sprites_init(&view->head, 1, next_id);
	sprites_init(&view->keys, 1, next_id);
	sprites_init(&view->key, 1, next_id);
	sprite_fill(&view->key, theme_accent);
}

void search_view_finish(struct search_view *view)
{
	free(view->found);
	for (uint32_t i = 0; i < SEARCH_ROWS; i++)
		sprites_finish(&view->rows[i].sprite, 1);
	sprites_finish(&view->head, 1);
	sprites_finish(&view->keys, 1);
	sprites_finish(&view->key, 1);
}

/* ---- layout ---- */

struct rect search_view_rect(const struct screen *screen)
{
	struct rect rect = screen_half(screen);
	int bar_px = screen->bar.y_px - screen_px(screen, THEME_GAP_MM);

	if (screen_is_flat(screen))
		return rect;
	if (screen_is_portrait(screen)) {
		if (rect.y_px > bar_px - screen_px(screen, HEIGHT_MM) && !screen->reach)
			rect.y_px = bar_px - screen_px(screen, HEIGHT_MM);
		if (rect.y_px < screen_px(screen, KEEP_MM))
			rect.y_px = 0;
		rect.height_px = bar_px - rect.y_px;
	} else if (rect.width_px < screen_px(screen, WIDTH_MM)) {
		rect = (struct rect){ 0, 0, screen->width_px, bar_px };
	} else if (screen->bar.x_px + screen->bar.width_px > rect.x_px) {
		rect.height_px = bar_px; /* with many languages the bar extends below it */
	}
	return rect;
}

static struct rect head_rect(const struct screen *screen)
{
	return paper_head(screen, search_view_rect(screen));
}

/* The place of list and keyboard: below the head, or on a flat panel above head and bar. */
static struct rect body_rect(const struct screen *screen)
{
	struct rect rect = search_view_rect(screen), head = head_rect(screen);

	if (screen_is_flat(screen)) {
		rect.height_px = head.y_px - rect.y_px;
		return rect;
	}
	rect.y_px += head.height_px;
	rect.height_px -= head.height_px;
	return rect;
}

/* Below the list, or on a flat panel beside it. */
struct rect search_view_keyboard(const struct search_view *view, const struct screen *screen)
{
	struct rect rect = body_rect(screen);

	rect.y_px += rect.height_px - view->keyboard.height_px;
	rect.height_px = view->keyboard.height_px;
	if (screen_is_flat(screen))
		rect.width_px /= 2;
	return rect;
}

struct rect search_view_list(const struct search_view *view, const struct screen *screen)
{
	struct rect rect = body_rect(screen);

	if (screen_is_flat(screen)) {
		rect.x_px = rect.width_px / 2;
		rect.width_px -= rect.x_px;
	} else {
		rect.height_px -= view->keyboard.height_px;
	}
	return rect;
}

static struct rect field_rect(const struct screen *screen)
{
	struct rect head = head_rect(screen), rect = paper_close(screen, head);
	int left_px = head.x_px + screen_px(screen, SIDE_MM);

	rect.width_px = rect.x_px - screen_px(screen, THEME_GAP_MM) - left_px;
	rect.x_px = left_px;
	return rect;
}

int search_view_row_px(const struct search_view *view, const struct screen *screen)
{
	int row_px = screen_text_px(screen, ROW_MM);
	int least_px = search_view_list(view, screen).height_px / (SEARCH_ROWS - 2);

	return row_px > least_px ? row_px : least_px;
}

/* If nothing is found, a row says so. */
static int row_count(const struct search_view *view)
{
	return view->found_count > 0 ? (int)view->found_count : 1;
}

int search_view_scroll_most(const struct search_view *view, const struct screen *screen)
{
	int most_px = row_count(view) * search_view_row_px(view, screen) -
		      search_view_list(view, screen).height_px;

	return most_px > 0 ? most_px : 0;
}

/* ---- state ---- */

static void lay_out_keyboard(struct search_view *view, const struct screen *screen, bool latin)
{
	struct rect body = body_rect(screen);

	if (screen_is_flat(screen))
		body.width_px /= 2;
	else
		body.height_px -= screen_px(screen, ROW_MM); /* at least one row stays visible */
	keyboard_layout(&view->keyboard, screen->theme, screen->theme->language, latin,
			body.width_px, body.height_px);
	view->keyboard_dirty = true;
	view->pressed = -1;
}

/* With nothing typed, all parts are listed in order of importance. */
static void list_all(struct search_view *view)
{
	for (uint32_t i = 0; i < view->part_count; i++)
		view->found[i] = i;
	view->found_count = view->part_count;
	view->scroll = (struct scroll){ 0 };
}

int search_view_reserve(struct search_view *view, uint32_t part_count)
{
	return ARRAY_RESERVE(view->found, view->found_room, part_count, UINT32_MAX);
}

void search_view_set_count(struct search_view *view, uint32_t part_count)
{
	if (part_count == view->part_count)
		return;
	view->part_count = part_count;
	view->found_count = 0;
	view->fade = (struct fade){ 0 };
}

void search_view_redraw(struct search_view *view, const struct screen *screen)
{
	view->head_dirty = true;
	for (uint32_t i = 0; i < SEARCH_ROWS; i++)
		view->rows[i].stale = true;
	if (view->fade.on)
		lay_out_keyboard(view, screen, false);
}

void search_view_picture_arrived(struct search_view *view, const struct parts *parts,
				 const char *name)
{
	for (uint32_t i = 0; i < SEARCH_ROWS; i++) {
		struct search_view_row *row = &view->rows[i];

		if (row->part >= 0 && row->part < (int)parts->count &&
		    strcmp(parts->list[row->part].thumbnail, name) == 0)
			row->stale = true;
	}
}

void search_view_open(struct search_view *view, const struct screen *screen, const char *query)
{
	snprintf(view->query, sizeof(view->query), "%s", query);
	view->fade.on = true;
	view->head_dirty = true;
	for (uint32_t i = 0; i < SEARCH_ROWS; i++) {
		struct search_view_row *row = &view->rows[i];

		*row = (struct search_view_row){ .part = ROW_NONE, .sprite = row->sprite };
	}
	lay_out_keyboard(view, screen, false);
	list_all(view);
}

void search_view_close(struct search_view *view)
{
	view->fade.on = false;
}

bool search_view_press(struct search_view *view, const struct screen *screen, int key)
{
	bool changed = false;

	if (key == OVERLAY_KEY_CLEAR) {
		changed = view->query[0] != 0;
		view->query[0] = 0;
	} else if (key >= 0 && key < (int)view->keyboard.key_count) {
		const struct keyboard_key *pressed = &view->keyboard.keys[key];

		view->pressed = key;
		view->press.alpha = 1;
		if (pressed->kind == KEY_LATIN)
			lay_out_keyboard(view, screen, !view->keyboard.latin);
		else
			changed = keyboard_type(pressed, view->query, sizeof(view->query));
	}
	view->head_dirty |= changed;
	if (changed && !view->query[0])
		list_all(view);
	return changed;
}

void search_view_set_found(struct search_view *view, const uint32_t *parts, uint32_t count)
{
	view->found_count = 0;
	for (uint32_t i = 0; i < count && view->found_count < view->part_count; i++)
		if (parts[i] < view->part_count)
			view->found[view->found_count++] = parts[i];
	view->scroll = (struct scroll){ 0 };
}

/* ---- touch ---- */

static struct overlay_action tap_head(const struct search_view *view, const struct screen *screen,
				      struct rect head, float x_px)
{
	struct overlay_action action = { .kind = OVERLAY_SWALLOWED, .part = -1 };
	struct rect field = field_rect(screen);
	float from_end_px = theme_is_right_to_left(screen->theme)
				    ? x_px - (float)field.x_px
				    : (float)(field.x_px + field.width_px) - x_px;

	if (x_px >= (float)paper_close(screen, head).x_px)
		action.kind = OVERLAY_SEARCH;
	else if (view->query[0] && from_end_px >= 0 && from_end_px < (float)head.height_px)
		action = (struct overlay_action){ .kind = OVERLAY_KEY,
						  .part = -1,
						  .key = OVERLAY_KEY_CLEAR };
	return action;
}

struct overlay_action search_view_tap(const struct search_view *view, const struct screen *screen,
				      float x_px, float y_px)
{
	struct overlay_action action = { .kind = OVERLAY_SWALLOWED, .part = -1 };
	struct rect keys = search_view_keyboard(view, screen);
	struct rect list = search_view_list(view, screen), head = head_rect(screen);

	if (rect_holds(head, x_px, y_px)) {
		action = tap_head(view, screen, head, x_px);
	} else if (rect_holds(keys, x_px, y_px)) {
		action.key = keyboard_key_at(&view->keyboard, x_px - (float)keys.x_px,
					     y_px - (float)keys.y_px);
		if (action.key >= 0)
			action.kind = OVERLAY_KEY;
	} else if (rect_holds(list, x_px, y_px)) {
		int row = (int)((y_px - (float)list.y_px + view->scroll.px) /
				(float)search_view_row_px(view, screen));

		if (row < (int)view->found_count) {
			action.kind = OVERLAY_FOUND;
			action.part = (int)view->found[row];
		}
	}
	return action;
}

/* ---- drawing ---- */

/* Draws the query with a caret behind it, or, while nothing is typed, what the field is for. */
static void draw_query(cairo_t *context, const struct screen *screen, const char *query, int x_px,
		       int width_px, int height_px)
{
	const struct theme *theme = screen->theme;
	/* Translators: stands in the empty search field. */
	const char *text = *query ? query : translate(theme->language, "Search");
	PangoLayout *layout = theme_layout(theme, TEXT_BODY, text, -1);
	bool mirrored = theme_is_right_to_left(theme), from_right = mirrored;
	int text_px, tall_px, left_px, caret_px = screen_px(screen, 0.5f);

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

static void draw_field(cairo_t *context, const struct screen *screen, const char *query)
{
	struct rect head = head_rect(screen), field = field_rect(screen);
	bool mirrored = theme_is_right_to_left(screen->theme);
	int icon_px = screen_px(screen, 4.0f), end_px = field.height_px;

	cairo_save(context);
	cairo_translate(context, field.x_px - head.x_px, field.y_px - head.y_px);
	theme_rounded(context, 0, 0, field.width_px, field.height_px,
		      screen_px(screen, THEME_RADIUS_MM));
	theme_set_source(context, theme_paper_shade, 1);
	cairo_fill(context);
	theme_set_source(context, theme_ink_soft, 1);
	icon_draw(context, ICON_SEARCH, mirrored ? field.width_px - end_px / 2.0 : end_px / 2.0,
		  field.height_px / 2.0, icon_px);
	if (query[0])
		icon_draw(context, ICON_CLOSE,
			  mirrored ? end_px / 2.0 : field.width_px - end_px / 2.0,
			  field.height_px / 2.0, screen_px(screen, 2.8f));
	draw_query(context, screen, query, end_px, field.width_px - 2 * end_px, field.height_px);
	cairo_restore(context);
}

static void draw_head(struct search_view *view, const struct screen *screen)
{
	struct rect head = head_rect(screen);
	cairo_t *context = sprite_begin(&view->head, head.width_px, head.height_px);

	if (!context)
		return;
	paper_draw_head(context, screen, head);
	draw_field(context, screen, view->query);
	sprite_end(&view->head, context);
}

static void draw_thumbnail(cairo_t *context, const struct screen *screen,
			   const struct picture_source *pictures, const char *name, int x_px,
			   int y_px, int side_px)
{
	struct found_picture found = { 0 };
	struct bitmap scaled;

	cairo_save(context);
	theme_rounded(context, x_px, y_px, side_px, side_px, screen_px(screen, 0.8f));
	cairo_clip(context);
	theme_set_source(context, theme_paper_shade, 1);
	cairo_paint(context);
	if (*name && pictures->get && pictures->get(pictures->data, name, &found) &&
	    found.picture && bitmap_from_picture(&scaled, found.picture, side_px, side_px) == 0) {
		cairo_set_source_surface(context, scaled.surface, x_px, y_px);
		cairo_paint(context);
		bitmap_finish(&scaled);
	}
	cairo_restore(context);
}

static void draw_part(cairo_t *context, const struct screen *screen,
		      const struct picture_source *pictures, const struct overlay_part *part,
		      int width_px, int height_px)
{
	const struct theme *theme = screen->theme;
	int side_px = screen_px(screen, SIDE_MM), gap_px = screen_px(screen, 1.5f);
	int picture_px = height_px - 2 * gap_px, padding_px = screen_px(screen, PADDING_MM);
	int text_px = width_px - 2 * side_px - picture_px - padding_px;
	int x_px = side_px + picture_px + padding_px, picture_x_px = side_px;
	int title_px, caption_px, y_px;

	if (theme_is_right_to_left(theme)) {
		x_px = side_px;
		picture_x_px = width_px - side_px - picture_px;
	}
	draw_thumbnail(context, screen, pictures, part->thumbnail, picture_x_px, gap_px,
		       picture_px);
	title_px = theme_line_px(theme, TEXT_BODY, part->title);
	caption_px = theme_line_px(theme, TEXT_FIGURE, part->caption);
	y_px = (height_px - title_px - (*part->caption ? caption_px : 0)) / 2;
	theme_show_line(context, theme, TEXT_BODY, theme_ink, part->title, x_px, y_px, text_px);
	theme_show_line(context, theme, TEXT_FIGURE, theme_ink_soft, part->caption, x_px,
			y_px + title_px, text_px);
	cairo_rectangle(context, side_px, height_px - 1, width_px - 2 * side_px, 1);
	theme_set_source(context, theme_line, 1);
	cairo_fill(context);
}

static void draw_row(struct search_view *view, const struct screen *screen,
		     const struct parts *parts, const struct picture_source *pictures,
		     struct search_view_row *row)
{
	int width_px = search_view_list(view, screen).width_px;
	int height_px = search_view_row_px(view, screen);
	int margin_px = screen_px(screen, SIDE_MM + PADDING_MM);
	cairo_t *context = sprite_begin(&row->sprite, width_px, height_px);

	if (!context)
		return;
	theme_set_source(context, theme_paper, 1);
	cairo_paint(context);
	if (row->part >= 0)
		draw_part(context, screen, pictures, &parts->list[row->part], width_px, height_px);
	else
		theme_show_line(context, screen->theme, TEXT_BODY, theme_ink_soft,
				translate(screen->theme->language, "No results"), margin_px,
				screen_px(screen, 5.0f), width_px - 2 * margin_px);
	sprite_end(&row->sprite, context);
}

/* ---- a frame ---- */

static bool update_rows(struct search_view *view, const struct screen *screen,
			const struct parts *parts, const struct picture_source *pictures,
			int64_t step_ms)
{
	int row_px = search_view_row_px(view, screen), first = (int)view->scroll.px / row_px;
	int last = ((int)view->scroll.px + search_view_list(view, screen).height_px) / row_px;
	uint32_t budget = ROWS_A_FRAME;
	bool moving = false;

	for (int i = first; i <= last && i < row_count(view); i++) {
		struct search_view_row *row = &view->rows[i % SEARCH_ROWS];
		int part = view->found_count > 0 ? (int)view->found[i] : ROW_NOTHING_FOUND;

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
			draw_row(view, screen, parts, pictures, row);
		}
		moving |= fade_advance(&row->fade, step_ms);
	}
	return moving;
}

bool search_view_update(struct search_view *view, const struct screen *screen,
			const struct parts *parts, const struct picture_source *pictures,
			int64_t step_ms)
{
	bool moving = false;

	if (view->scroll.px_per_s != 0)
		moving |= scroll_advance(&view->scroll, search_view_scroll_most(view, screen),
					 step_ms);
	moving |= fade_advance(&view->fade, step_ms);
	if (view->fade.alpha == 0 && !view->fade.on)
		return moving;
	moving |= fade_advance(&view->press, step_ms);
	if (view->keyboard_dirty) {
		struct bitmap fresh;
		int rc = keyboard_draw(&fresh, &view->keyboard, screen->theme);

		sprite_take(&view->keys, &fresh, rc);
	}
	if (view->head_dirty)
		draw_head(view, screen);
	view->keyboard_dirty = view->head_dirty = false;
	if (view->fade.on)
		moving |= update_rows(view, screen, parts, pictures, step_ms);
	return moving;
}

static void add_pressed(const struct search_view *view, struct layers *layers,
			struct paper_slide slide, struct rect keys)
{
	const struct keyboard_key *key;

	if (view->pressed < 0)
		return;
	key = &view->keyboard.keys[view->pressed];
	layers_add_stretched(layers, &view->key, slide.alpha * PRESS * view->press.alpha,
			     (float)(keys.x_px + key->x_px) + slide.dx_px,
			     (float)(keys.y_px + key->y_px) + slide.dy_px, (float)key->width_px,
			     (float)key->height_px);
}

void search_view_layers(const struct search_view *view, const struct screen *screen,
			const struct paper *paper, struct layers *layers)
{
	const struct rect all = search_view_rect(screen), list = search_view_list(view, screen);
	const struct rect keys = search_view_keyboard(view, screen);
	const struct paper_slide slide = paper_slide(screen, &view->fade);
	const int row_px = search_view_row_px(view, screen);

	if (slide.alpha <= 0)
		return;
	paper_add_ground(paper, layers, slide, all);
	for (uint32_t i = 0; i < SEARCH_ROWS; i++) {
		const struct search_view_row *row = &view->rows[i];
		const float top =
			(float)list.y_px - roundf(view->scroll.px) + (float)(row->index * row_px);

		if (row->fade.on && row->index < row_count(view))
			layers_add_clipped(layers, &row->sprite,
					   slide.alpha * fade_eased(&row->fade), list, top,
					   slide.dx_px, slide.dy_px);
	}
	paper_add_mark(paper, layers, slide, list, view->scroll.px,
		       search_view_scroll_most(view, screen));
	paper_add_at(layers, &view->head, slide, paper_head(screen, all));
	paper_add_at(layers, &view->keys, slide, keys);
	add_pressed(view, layers, slide, keys);
}
