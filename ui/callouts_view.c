/* Assigns callouts to labels, fades them and draws them with their leaders. */
#include "ui/callouts_view.h"

#include <math.h>
#include <stdlib.h>

#include "base/array.h"

_Static_assert((int)CALLOUT_LABELS >= 2 * (int)CALLOUTS_MAX, "labels that come and labels that go");

#define DETAIL     0.05f /* share of the scene's height; smaller parts are details */
#define DIM        0.6f  /* share of its alpha that a callout loses while its part is hidden */
#define PADDING_MM 2.2f
#define LEADER_MM  1.5f
#define DOT_MM     3.2f

enum {
	HIDDEN_MS = 1500,   /* how long a callout stays after its part is hidden */
	LABELS_A_FRAME = 4, /* labels drawn in one update */
};

/* ---- what never changes ---- */

/* A leader in cross-section: a light core between dark edges, so that it shows on any material. */
static void draw_leader(struct sprite *sprite, const struct theme *theme)
{
	int across_px = theme_px(theme, LEADER_MM) + 2;
	cairo_t *context = sprite_begin(sprite, 4, across_px);

	if (!context)
		return;
	cairo_rectangle(context, 0, 1, 4, across_px - 2);
	theme_set_source(context, theme_night, 0.72);
	cairo_fill(context);
	cairo_rectangle(context, 0, across_px * 0.34, 4, across_px * 0.32);
	theme_set_source(context, theme_night_text, 1);
	cairo_fill(context);
	sprite_end(sprite, context);
}

static void draw_dot(struct sprite *sprite, const struct theme *theme)
{
	int side_px = theme_px(theme, DOT_MM);
	double middle = side_px / 2.0, turn = 4 * acos(0.0);
	cairo_t *context = sprite_begin(sprite, side_px, side_px);

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
	sprite_end(sprite, context);
}

void callouts_view_init(struct callouts_view *view, const struct theme *theme, uint32_t *next_id)
{
	*view = (struct callouts_view){ 0 };
	for (uint32_t i = 0; i < CALLOUT_LABELS; i++)
		sprites_init(&view->labels[i].sprite, 1, next_id);
	sprites_init(&view->leader, 1, next_id);
	sprites_init(&view->dot, 1, next_id);
	callouts_view_forget(view);
	draw_leader(&view->leader, theme);
	draw_dot(&view->dot, theme);
}

void callouts_view_finish(struct callouts_view *view)
{
	free(view->parts);
	free(view->anchors);
	for (uint32_t i = 0; i < CALLOUT_LABELS; i++)
		sprites_finish(&view->labels[i].sprite, 1);
	sprites_finish(&view->leader, 1);
	sprites_finish(&view->dot, 1);
}

/* ---- parts ---- */

int callouts_view_reserve(struct callouts_view *view, uint32_t part_count)
{
	int rc = ARRAY_RESERVE(view->parts, view->part_room, part_count, UINT32_MAX);

	return rc < 0 ? rc
		      : ARRAY_RESERVE(view->anchors, view->anchor_room, part_count, UINT32_MAX);
}

void callouts_view_set_parts(struct callouts_view *view, const struct theme *theme,
			     const struct parts *parts)
{
	view->part_count = parts->count;
	for (uint32_t i = 0; i < parts->count; i++)
		view->parts[i] = (struct callouts_view_part){ 0 };
	callouts_view_measure(view, theme, parts);
}

static int measure(const struct theme *theme, const char *title)
{
	PangoLayout *layout = theme_layout(theme, TEXT_LABEL, title, -1);
	int width_px;

	pango_layout_get_pixel_size(layout, &width_px, NULL);
	g_object_unref(layout);
	return width_px + 2 * theme_px(theme, PADDING_MM);
}

void callouts_view_measure(struct callouts_view *view, const struct theme *theme,
			   const struct parts *parts)
{
	view->column_px = 0;
	for (uint32_t i = 0; i < view->part_count; i++) {
		const int label_px = measure(theme, parts->list[i].title);

		view->parts[i].label_px = label_px;
		if (label_px > view->column_px)
			view->column_px = label_px;
	}
	callouts_view_forget(view);
}

static void free_label(struct callouts_view_label *label)
{
	*label = (struct callouts_view_label){ .part = -1, .sprite = label->sprite };
}

void callouts_view_forget(struct callouts_view *view)
{
	for (uint32_t i = 0; i < CALLOUT_LABELS; i++)
		free_label(&view->labels[i]);
	view->callouts.count = 0;
	view->dirty = true;
}

void callouts_view_anchors(struct callouts_view *view, const struct overlay_anchor *anchors,
			   uint32_t count)
{
	for (uint32_t i = 0; i < count && i < view->part_count; i++)
		view->parts[i].anchor = anchors[i];
	view->dirty = true;
}

/* ---- layout ---- */

int callouts_view_row_px(const struct screen *screen)
{
	return screen_text_px(screen, THEME_TARGET_MM);
}

static struct callout_area area_of(const struct callouts_view *view, const struct screen *screen,
				   const struct callouts_view_room *room)
{
	const struct rect scene = screen->scene;
	int margin_px = screen_px(screen, THEME_MARGIN_MM), floor_px = room->floor_px, most_px;
	struct callout_area area = { .x_px = scene.x_px + margin_px,
				     .y_px = scene.y_px + margin_px,
				     .width_px = scene.width_px - 2 * margin_px,
				     .row_px = callouts_view_row_px(screen),
				     .gap_px = screen_px(screen, THEME_GAP_MM),
				     .lead_px = margin_px };

	if (screen->reach) {
		if (room->right_px < area.x_px + area.width_px)
			area.width_px = room->right_px - area.x_px - margin_px;
		area.above_px = screen_reach_top(screen) - area.y_px;
		area.y_px = screen_reach_top(screen);
		if (room->taken)
			floor_px = area.y_px;
	}
	area.height_px = floor_px - area.y_px;
	area.column_px = view->column_px;
	/* About half of the width is the model's; beside a page, where it is narrow, a little
	 * less. */
	most_px = area.width_px * (scene.width_px < screen->width_px ? 31 : 27) / 100;
	if (area.column_px > most_px)
		area.column_px = most_px;
	area.detail_px = (float)scene.height_px * DETAIL;
	return area;
}

static struct callouts_view_label *find_label(struct callouts_view *view, int part)
{
	for (uint32_t i = 0; i < CALLOUT_LABELS; i++)
		if (view->labels[i].part == part)
			return &view->labels[i];
	return NULL;
}

/* Returns a free label, or the faintest of those that fade out. There are more labels than
 * callouts. */
static struct callouts_view_label *take_label(struct callouts_view *view)
{
	struct callouts_view_label *best = NULL;

	for (uint32_t i = 0; i < CALLOUT_LABELS; i++) {
		struct callouts_view_label *label = &view->labels[i];

		if (label->part >= 0 && label->fade.on)
			continue;
		if (!best || label->part < 0 ||
		    (best->part >= 0 && label->fade.alpha < best->fade.alpha))
			best = label;
		if (best->part < 0)
			break;
	}
	return best;
}

static void show_label(struct callouts_view *view, const struct screen *screen,
		       const struct callout *place)
{
	struct callouts_view_label *label = find_label(view, (int)place->part);

	if (!label) {
		label = take_label(view);
		if (!label)
			return;
		free_label(label);
		label->part = (int)place->part;
	} else if (label->place.left != place->left ||
		   abs(label->place.y_px - place->y_px) > callouts_view_row_px(screen)) {
		label->fade.alpha = 0; /* it changed its place: fade in again, do not jump */
	}
	label->place = *place;
	label->fade.on = true;
}

static bool may_have_callout(struct callouts_view *view, int part)
{
	const struct callouts_view_label *label = find_label(view, part);
	const struct overlay_anchor *anchor = &view->parts[part].anchor;

	return anchor->visible &&
	       (!anchor->hidden || (label && label->fade.on && label->hidden_ms < HIDDEN_MS));
}

static bool is_chosen(const struct callouts_view_room *room, int part)
{
	return part == room->chosen[0] || part == room->chosen[1];
}

static void lay_out(struct callouts_view *view, const struct screen *screen,
		    const struct callouts_view_room *room)
{
	const struct callout_area area = area_of(view, screen, room);

	for (uint32_t i = 0; i < view->part_count; i++) {
		const struct callouts_view_part *part = &view->parts[i];

		view->anchors[i] = (struct callout_anchor){
			.x_px = part->anchor.x_px,
			.y_px = part->anchor.y_px,
			.visible = may_have_callout(view, (int)i),
			.label_px =
				part->label_px < area.column_px ? part->label_px : area.column_px,
			.size_px = is_chosen(room, (int)i) ? 0 : part->anchor.size_px,
		};
	}
	callouts_layout(&view->callouts, &area, view->anchors, view->part_count);
	for (uint32_t i = 0; i < CALLOUT_LABELS; i++)
		view->labels[i].fade.on = false;
	for (uint32_t i = 0; i < view->callouts.count; i++)
		show_label(view, screen, &view->callouts.list[i]);
}

/* ---- touch ---- */

int callouts_view_part_at(const struct callouts_view *view, const struct screen *screen, float x_px,
			  float y_px)
{
	for (uint32_t i = 0; i < CALLOUT_LABELS; i++) {
		const struct callouts_view_label *label = &view->labels[i];
		const struct rect rect = { label->place.x_px, label->place.y_px,
					   label->place.width_px, callouts_view_row_px(screen) };

		if (label->part >= 0 && label->fade.on && rect_holds(rect, x_px, y_px))
			return label->part;
	}
	return -1;
}

/* ---- drawing ---- */

static void draw_label(struct callouts_view_label *label, const struct screen *screen,
		       const char *title, bool chosen)
{
	int width_px = label->place.width_px, height_px = callouts_view_row_px(screen), text_px;
	int padding_px = screen_px(screen, PADDING_MM), inset_px = screen_px(screen, 0.6f);
	cairo_t *context = sprite_begin(&label->sprite, width_px, height_px);
	PangoLayout *layout;

	label->drawn = true;
	label->drawn_chosen = chosen;
	if (!context)
		return;
	theme_rounded(context, 0, inset_px, width_px, height_px - 2 * inset_px,
		      screen_px(screen, THEME_RADIUS_MM));
	if (chosen)
		theme_set_source(context, theme_accent, THEME_CHOSEN_ALPHA);
	else
		theme_set_source(context, theme_night, THEME_LABEL_ALPHA);
	cairo_fill(context);
	layout = theme_layout(screen->theme, TEXT_LABEL, title, -1);
	/* One pixel more, so that rounding does not cut a text that fits. */
	theme_limit_lines(layout, width_px - 2 * padding_px + 1, 1);
	pango_layout_get_pixel_size(layout, NULL, &text_px);
	theme_set_source(context, theme_night_text, 1);
	cairo_move_to(context, padding_px, (height_px - text_px) / 2.0);
	pango_cairo_show_layout(context, layout);
	g_object_unref(layout);
	sprite_end(&label->sprite, context);
}

/* ---- a frame ---- */

/* Dims a label while its part is hidden. A short occlusion, as by a passing pillar, removes
 * nothing. */
static bool watch_hidden(struct callouts_view *view, struct callouts_view_label *label,
			 int64_t step_ms)
{
	label->dim.on = view->parts[label->part].anchor.hidden;
	if (!label->dim.on || !label->fade.on) {
		label->hidden_ms = 0;
		return fade_advance(&label->dim, step_ms);
	}
	label->hidden_ms += step_ms;
	view->dirty |= label->hidden_ms >= HIDDEN_MS;
	fade_advance(&label->dim, step_ms);
	return true;
}

bool callouts_view_update(struct callouts_view *view, const struct screen *screen,
			  const struct parts *parts, const struct callouts_view_room *room,
			  int64_t step_ms)
{
	uint32_t budget = LABELS_A_FRAME;
	bool moving = false;

	if (view->dirty)
		lay_out(view, screen, room);
	view->dirty = false;
	for (uint32_t i = 0; i < CALLOUT_LABELS; i++) {
		struct callouts_view_label *label = &view->labels[i];
		bool chosen;

		if (label->part < 0)
			continue;
		chosen = is_chosen(room, label->part);
		if (label->fade.on && (!label->drawn || label->drawn_chosen != chosen ||
				       label->sprite.bitmap.width_px != label->place.width_px)) {
			if (budget == 0) {
				moving = true;
				continue;
			}
			draw_label(label, screen, parts->list[label->part].title, chosen);
			budget--;
		}
		moving |= fade_advance(&label->fade, step_ms);
		moving |= watch_hidden(view, label, step_ms);
		if (!label->fade.on && label->fade.alpha == 0)
			free_label(label);
	}
	return moving;
}

/* ---- layers ---- */

static float alpha_of(const struct callouts_view_label *label)
{
	return fade_eased(&label->fade) * (1 - DIM * fade_eased(&label->dim));
}

static void add_leader(const struct callouts_view *view, const struct callouts_view_label *label,
		       struct layers *layers)
{
	const struct callout *c = &label->place;
	float dx = c->anchor_x_px - c->port_x_px, dy = c->anchor_y_px - c->port_y_px;
	float length = hypotf(dx, dy);
	float half = (float)view->leader.bitmap.height_px / 2;
	struct overlay_layer *layer;
	float nx, ny;

	if (length < 1)
		return;
	layer = layers_add(layers, &view->leader, alpha_of(label));
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

/* All leaders are below all dots, and all dots below all labels. */
void callouts_view_layers(const struct callouts_view *view, struct layers *layers)
{
	const float half = (float)view->dot.bitmap.width_px / 2;

	for (uint32_t i = 0; i < CALLOUT_LABELS; i++)
		if (view->labels[i].drawn)
			add_leader(view, &view->labels[i], layers);
	for (uint32_t i = 0; i < CALLOUT_LABELS; i++) {
		const struct callouts_view_label *label = &view->labels[i];

		if (label->drawn)
			layers_add_at(layers, &view->dot, alpha_of(label),
				      label->place.anchor_x_px - half,
				      label->place.anchor_y_px - half);
	}
	for (uint32_t i = 0; i < CALLOUT_LABELS; i++) {
		const struct callouts_view_label *label = &view->labels[i];

		if (label->drawn)
			layers_add_at(layers, &label->sprite, alpha_of(label),
				      (float)label->place.x_px, (float)label->place.y_px);
	}
}
