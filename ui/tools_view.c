/* Places the discs of the tools, finds their handles and draws them. */
#include "ui/tools_view.h"

#include <math.h>

#include "ui/icon.h"
#include "ui/translate.h"

#define DISC_MM    44.0f
#define PADDING_MM 2.0f
#define HEAD_MM    7.0f /* the line with the tool's name */
#define LINE_MM    0.9f

static const unsigned tool_bits[OVERLAY_DISC_COUNT] = { OVERLAY_TOOL_LIGHT, OVERLAY_TOOL_SECTION };

void tools_view_init(struct tools_view *view, uint32_t *next_id)
{
	*view = (struct tools_view){ .fit = true };
	sprites_init(view->discs, OVERLAY_DISC_COUNT, next_id);
	sprites_init(&view->knob, 1, next_id);
	sprites_init(&view->push_knob, 1, next_id);
	sprites_init(&view->line, 1, next_id);
}

void tools_view_finish(struct tools_view *view)
{
	sprites_finish(view->discs, OVERLAY_DISC_COUNT);
	sprites_finish(&view->knob, 1);
	sprites_finish(&view->push_knob, 1);
	sprites_finish(&view->line, 1);
}

/* ---- layout ---- */

static int head_px(const struct screen *screen)
{
	return screen_text_px(screen, HEAD_MM);
}

/* The size of a disc: both must fit beside each other. */
static int disc_px(const struct tools_view *view, const struct screen *screen)
{
	const struct rect scene = screen->scene;
	const int gap = screen_px(screen, THEME_GAP_MM), padding = screen_px(screen, PADDING_MM);
	const int reach = screen_reach_top(screen), top = reach > scene.y_px ? reach : scene.y_px;
	const int high = screen_floor(screen) - top - gap - head_px(screen) - padding;
	const unsigned both = OVERLAY_TOOL_LIGHT | OVERLAY_TOOL_SECTION;
	const int count = (view->offered & both) == both ? 2 : 1;
	const int wide = (scene.width_px - (count + 1) * gap) / count - 2 * padding;
	int side = screen_px(screen, DISC_MM);

	side = side < high ? side : high;
	side = side < wide ? side : wide;
	return side > 1 ? side : 1;
}

struct rect tools_view_rect(const struct tools_view *view, const struct screen *screen, int tool)
{
	const struct rect scene = screen->scene;
	const int gap = screen_px(screen, THEME_GAP_MM), side = disc_px(view, screen);
	const int width = side + 2 * screen_px(screen, PADDING_MM);
	const int height = side + head_px(screen) + screen_px(screen, PADDING_MM);
	/* The first offered tool is the outermost, whatever is on. */
	const int place = tool > 0 && view->offered & tool_bits[0] ? 1 : 0;

	return (struct rect){ scene.x_px + scene.width_px - (place + 1) * (width + gap),
			      screen_floor(screen) - height, width, height };
}

bool tools_view_shows(const struct tools_view *view, const struct screen *screen,
		      const struct tools_view_obstacles *obstacles, int tool)
{
	const struct rect rect = tools_view_rect(view, screen, tool);

	if (!view->fit || !(view->now.on & view->offered & tool_bits[tool]) || obstacles->all)
		return false;
	for (uint32_t i = 0; i < obstacles->count; i++)
		if (rect_meets(rect, obstacles->rects[i]))
			return false;
	return true;
}

int tools_view_top(const struct tools_view *view, const struct screen *screen,
		   const struct tools_view_obstacles *obstacles)
{
	int top = screen->height_px;

	for (int tool = 0; tool < OVERLAY_DISC_COUNT; tool++)
		if (tools_view_shows(view, screen, obstacles, tool))
			top = tools_view_rect(view, screen, tool).y_px;
	return top;
}

int tools_view_left(const struct tools_view *view, const struct screen *screen,
		    const struct tools_view_obstacles *obstacles)
{
	int left = screen->width_px;

	for (int tool = 0; tool < OVERLAY_DISC_COUNT; tool++)
		if (tools_view_shows(view, screen, obstacles, tool) &&
		    tools_view_rect(view, screen, tool).x_px < left)
			left = tools_view_rect(view, screen, tool).x_px;
	return left;
}

/* The ring that the knobs slide on. A knob always lies completely on the disc. */
static void ring_of(const struct tools_view *view, const struct screen *screen, int tool,
		    float *x_px, float *y_px, float *radius_px)
{
	const struct rect rect = tools_view_rect(view, screen, tool);
	const float side = (float)disc_px(view, screen);

	*x_px = (float)rect.x_px + (float)rect.width_px / 2;
	*y_px = (float)(rect.y_px + head_px(screen)) + side / 2;
	*radius_px = fmaxf((side - (float)screen_px(screen, THEME_TARGET_MM)) / 2 - 1, 1);
}

void tools_view_knobs(const struct tools_view *view, const struct screen *screen,
		      struct tools_view_knobs *out)
{
	const struct overlay_tools *now = &view->now;
	const float right = -sinf(now->turn_rad), up = cosf(now->turn_rad);
	float x, y, radius;

	ring_of(view, screen, 0, &x, &y, &radius);
	out->light[0] = x + now->light_at[0] * radius;
	out->light[1] = y - now->light_at[1] * radius;
	ring_of(view, screen, 1, &x, &y, &radius);
	out->turn[0] = x + right * radius;
	out->turn[1] = y - up * radius;
	out->along[0] = right;
	out->along[1] = -up;
	out->push[0] = x + right * radius * now->push;
	out->push[1] = y - up * radius * now->push;
	out->line_px = radius * sqrtf(fmaxf(1 - now->push * now->push, 0.02f));
	out->thick_px = (float)screen_px(screen, LINE_MM) / 2;
}

/* ---- touch ---- */

bool tools_view_covers(const struct tools_view *view, const struct screen *screen,
		       const struct tools_view_obstacles *obstacles, float x_px, float y_px)
{
	for (int tool = 0; tool < OVERLAY_DISC_COUNT; tool++)
		if (tools_view_shows(view, screen, obstacles, tool) &&
		    rect_holds(tools_view_rect(view, screen, tool), x_px, y_px))
			return true;
	return false;
}

enum overlay_handle tools_view_handle_at(const struct tools_view *view, const struct screen *screen,
					 const struct tools_view_obstacles *obstacles, float x_px,
					 float y_px)
{
	const float knob_px = (float)screen_px(screen, THEME_TARGET_MM);
	float x, y, radius;

	for (int tool = 0; tool < OVERLAY_DISC_COUNT; tool++) {
		if (!tools_view_shows(view, screen, obstacles, tool))
			continue;
		ring_of(view, screen, tool, &x, &y, &radius);
		const float far = hypotf(x_px - x, y_px - y);

		if (far > (float)disc_px(view, screen) / 2)
			continue;
		if (tool_bits[tool] == OVERLAY_TOOL_LIGHT)
			return OVERLAY_HANDLE_LIGHT;
		return far > radius - knob_px / 2 ? OVERLAY_HANDLE_TURN : OVERLAY_HANDLE_PUSH;
	}
	return OVERLAY_HANDLE_NONE;
}

void tools_view_handle_place(const struct tools_view *view, const struct screen *screen,
			     enum overlay_handle handle, float x_px, float y_px, float at[2])
{
	float x, y, radius;

	ring_of(view, screen, handle == OVERLAY_HANDLE_LIGHT ? 0 : 1, &x, &y, &radius);
	at[0] = (x_px - x) / radius;
	at[1] = (y - y_px) / radius;
}

/* ---- drawing ---- */

static void draw_disc(struct tools_view *view, const struct screen *screen, int tool)
{
	/* Translators: two tools: light from the side, which shows relief, and a cut model. */
	static const char *const names[OVERLAY_DISC_COUNT] = { N_("Raking light"),
							       N_("Cross-section") };
	const struct rect rect = tools_view_rect(view, screen, tool);
	cairo_t *context = sprite_begin(&view->discs[tool], rect.width_px, rect.height_px);
	const double turn = 4 * acos(0.0), line = screen_px(screen, 0.35f);
	const int padding = screen_px(screen, PADDING_MM);
	float x, y, radius;
	int height_px;
	PangoLayout *layout;

	if (!context)
		return;
	ring_of(view, screen, tool, &x, &y, &radius);
	x -= (float)rect.x_px;
	y -= (float)rect.y_px;
	theme_rounded(context, 0, 0, rect.width_px, rect.height_px,
		      screen_px(screen, THEME_RADIUS_MM));
	theme_set_source(context, theme_night, THEME_CHIP_ALPHA);
	cairo_fill(context);
	layout = theme_layout(screen->theme, TEXT_BUTTON,
			      translate(screen->theme->language, names[tool]), -1);
	theme_limit_lines(layout, rect.width_px - 2 * padding, 1);
	pango_layout_set_alignment(layout, PANGO_ALIGN_CENTER);
	pango_layout_get_pixel_size(layout, NULL, &height_px);
	theme_set_source(context, theme_night_text, 1);
	cairo_move_to(context, padding, ((double)(y - radius) - height_px) / 2);
	pango_cairo_show_layout(context, layout);
	g_object_unref(layout);

	cairo_set_line_width(context, line);
	cairo_new_sub_path(context);
	cairo_arc(context, (double)x, (double)y, (double)radius, 0, turn);
	theme_set_source(context, theme_night_text, 0.14);
	cairo_fill_preserve(context);
	theme_set_source(context, theme_night_text, 0.8);
	cairo_stroke(context);
	if (tool_bits[tool] == OVERLAY_TOOL_LIGHT) {
		theme_set_source(context, theme_night_text, THEME_DIM_ALPHA);
		cairo_arc(context, (double)x, (double)y, (double)radius / 2, 0, turn);
		cairo_stroke(context);
	} else { /* a mark for the viewer, who stands below */
		const double side = screen_px(screen, 1.6f);
		const double foot = (double)(y + radius) - 3 * line;

		theme_set_source(context, theme_night_text, THEME_DIM_ALPHA);
		cairo_move_to(context, (double)x - side, foot);
		cairo_line_to(context, (double)x, foot - 1.4 * side);
		cairo_line_to(context, (double)x + side, foot);
		cairo_close_path(context);
		cairo_fill(context);
	}
	sprite_end(&view->discs[tool], context);
}

static void draw_knob(struct sprite *sprite, const struct screen *screen, struct colour colour,
		      bool has_arrows)
{
	const int side = screen_px(screen, THEME_TARGET_MM);
	const double middle = side / 2.0, turn = 4 * acos(0.0);
	cairo_t *context = sprite_begin(sprite, side, side);

	if (!context)
		return;
	cairo_arc(context, middle, middle, middle * 0.86, 0, turn);
	theme_set_source(context, theme_night, 1);
	cairo_fill(context);
	cairo_arc(context, middle, middle, middle * 0.76, 0, turn);
	theme_set_source(context, colour, 1);
	cairo_fill(context);
	theme_set_source(context, has_arrows ? theme_paper : theme_night, 1);
	if (has_arrows)
		icon_draw(context, ICON_PUSH, middle, middle, middle * 0.9);
	sprite_end(sprite, context);
}

static void draw_line(struct sprite *sprite, const struct screen *screen)
{
	cairo_t *context = sprite_begin(sprite, 8, screen_px(screen, LINE_MM));

	if (!context)
		return;
	theme_set_source(context, theme_accent, 1);
	cairo_paint(context);
	sprite_end(sprite, context);
}

/* ---- a frame ---- */

bool tools_view_update(struct tools_view *view, const struct screen *screen,
		       const struct tools_view_obstacles *obstacles, int64_t step_ms, bool *moved)
{
	const struct rect rect = tools_view_rect(view, screen, 0);
	bool moving = false;

	if (!view->offered)
		return false;
	view->dirty |=
		rect.width_px != view->drawn_width_px || rect.height_px != view->drawn_height_px;
	for (int tool = 0; tool < OVERLAY_DISC_COUNT; tool++) {
		const bool shows = tools_view_shows(view, screen, obstacles, tool);

		*moved |= shows != view->fades[tool].on;
		view->fades[tool].on = shows;
		moving |= fade_advance(&view->fades[tool], step_ms);
	}
	if (view->dirty && view->now.on) {
		view->drawn_width_px = rect.width_px;
		view->drawn_height_px = rect.height_px;
		for (int tool = 0; tool < OVERLAY_DISC_COUNT; tool++)
			draw_disc(view, screen, tool);
		draw_knob(&view->knob, screen, theme_night_text, false);
		draw_knob(&view->push_knob, screen, theme_accent, true);
		draw_line(&view->line, screen);
		view->dirty = false;
	}
	return moving;
}

void tools_view_layers(const struct tools_view *view, const struct screen *screen,
		       struct layers *layers)
{
	const float knob = (float)view->knob.bitmap.width_px / 2;
	const float upright[2] = { 0, -1 };
	float alpha[OVERLAY_DISC_COUNT];
	struct tools_view_knobs knobs;

	tools_view_knobs(view, screen, &knobs);
	for (int tool = 0; tool < OVERLAY_DISC_COUNT; tool++) {
		const struct rect rect = tools_view_rect(view, screen, tool);

		alpha[tool] = fade_eased(&view->fades[tool]);
		layers_add_at(layers, &view->discs[tool], alpha[tool], (float)rect.x_px,
			      (float)rect.y_px);
	}
	layers_add_turned(layers, &view->knob, alpha[0], knobs.light, upright, knob, knob);
	layers_add_turned(layers, &view->line, alpha[1], knobs.push, knobs.along, knobs.line_px,
			  knobs.thick_px);
	layers_add_turned(layers, &view->knob, alpha[1], knobs.turn, upright, knob, knob);
	layers_add_turned(layers, &view->push_knob, alpha[1], knobs.push, knobs.along, knob, knob);
}
