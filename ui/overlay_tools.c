/* The control discs of the tools: a lamp on its ring, and a section seen from above. Each disc has
 * its own place above the bar's line, at the right end of the scene, and shows unless something
 * open covers that place. */
#include <math.h>

#include "ui/icon.h"
#include "ui/overlay_state.h"
#include "ui/translate.h"

#define DISC_MM    44.0f
#define PADDING_MM 2.0f
#define HEAD_MM    7.0f /* the line with the tool's name */
#define LINE_MM    0.9f

static const unsigned tool_bits[OVERLAY_TOOL_COUNT] = { OVERLAY_TOOL_LIGHT, OVERLAY_TOOL_SECTION };

static int px(const struct overlay *overlay, float mm)
{
	return theme_px(&overlay->theme, mm);
}

/* ---- state ---- */

void overlay_offer_tools(struct overlay *overlay, unsigned tools)
{
	if (tools == overlay->tools.offered)
		return;
	overlay->tools.offered = tools;
	overlay->tools.dirty = true;
	overlay_lay_out_chrome(overlay);
}

unsigned overlay_tools_offered(const struct overlay *overlay)
{
	return overlay->chrome.toolless ? 0 : overlay->tools.offered;
}

void overlay_show_tools(struct overlay *overlay, const struct overlay_tools *state)
{
	const unsigned changed = overlay->tools.now.on ^ state->on;

	overlay->tools.now = *state;
	if (!changed)
		return;
	overlay->tools.dirty = overlay->chrome_dirty = overlay->callouts_dirty = true;
	if (changed & state->on)
		overlay_show_help(overlay,
				  false); /* help and tools share their place on small panels */
}

/* ---- layout ---- */

static int head_px(const struct overlay *overlay)
{
	return theme_text_px(&overlay->theme, HEAD_MM);
}

/* The size of a disc: both must fit beside each other. */
static int disc_px(const struct overlay *overlay)
{
	const struct rect scene = overlay_scene_rect(overlay);
	const int gap = px(overlay, THEME_GAP_MM), padding = px(overlay, PADDING_MM);
	const int top =
		overlay_reach_top(overlay) > scene.y_px ? overlay_reach_top(overlay) : scene.y_px;
	const int high =
		overlay_above_floor(overlay, 0, 0).y_px - top - gap - head_px(overlay) - padding;
	const int count =
		overlay->tools.offered == (OVERLAY_TOOL_LIGHT | OVERLAY_TOOL_SECTION) ? 2 : 1;
	const int wide = (scene.width_px - (count + 1) * gap) / count - 2 * padding;
	int side = px(overlay, DISC_MM);

	side = side < high ? side : high;
	side = side < wide ? side : wide;
	return side > 1 ? side : 1;
}

struct rect overlay_tool_rect(const struct overlay *overlay, int tool)
{
	const struct rect scene = overlay_scene_rect(overlay);
	const int gap = px(overlay, THEME_GAP_MM), side = disc_px(overlay);
	const int width = side + 2 * px(overlay, PADDING_MM);
	const int height = side + head_px(overlay) + px(overlay, PADDING_MM);
	/* The first offered tool is the outermost, whatever is on. */
	const int place = tool > 0 && overlay->tools.offered & tool_bits[0] ? 1 : 0;

	return (struct rect){ scene.x_px + scene.width_px - (place + 1) * (width + gap),
			      overlay_above_floor(overlay, 0, 0).y_px - height, width, height };
}

/* Text has priority over controls: a disc hides, but its tool stays on and keeps its effect. */
bool overlay_tool_shows(const struct overlay *overlay, int tool)
{
	const struct rect rect = overlay_tool_rect(overlay, tool);

	if (!(overlay->tools.now.on & overlay_tools_offered(overlay) & tool_bits[tool]) ||
	    overlay->gallery.fade.on || overlay->invitation.on)
		return false;
	if (overlay->search.fade.on && rect_meets(rect, overlay_search_rect(overlay)))
		return false;
	if (overlay->page_part >= 0 && rect_meets(rect, overlay_page_rect(overlay)))
		return false;
	if (overlay->card_part >= 0 && rect_meets(rect, overlay_card_rect(overlay)))
		return false;
	if (overlay->help.on && rect_meets(rect, overlay_help_rect(overlay)))
		return false;
	if (overlay_choosing(overlay) && rect_meets(rect, overlay_menu_rect(overlay)))
		return false;
	return !overlay_tour_shows(overlay) || !rect_meets(rect, overlay_tour_rect(overlay));
}

int overlay_tools_top(const struct overlay *overlay)
{
	int top = overlay->height_px;

	for (int tool = 0; tool < OVERLAY_TOOL_COUNT; tool++)
		if (overlay_tool_shows(overlay, tool))
			top = overlay_tool_rect(overlay, tool).y_px;
	return top;
}

int overlay_tools_left(const struct overlay *overlay)
{
	int left = overlay->width_px;

	for (int tool = 0; tool < OVERLAY_TOOL_COUNT; tool++)
		if (overlay_tool_shows(overlay, tool) &&
		    overlay_tool_rect(overlay, tool).x_px < left)
			left = overlay_tool_rect(overlay, tool).x_px;
	return left;
}

/* The ring that the knobs slide on. A knob always lies completely on the disc. */
static void ring_of(const struct overlay *overlay, int tool, float *x_px, float *y_px,
		    float *radius_px)
{
	const struct rect rect = overlay_tool_rect(overlay, tool);
	const float side = (float)disc_px(overlay);

	*x_px = (float)rect.x_px + (float)rect.width_px / 2;
	*y_px = (float)(rect.y_px + head_px(overlay)) + side / 2;
	*radius_px = fmaxf((side - (float)px(overlay, THEME_TARGET_MM)) / 2 - 1, 1);
}

/* ---- touch ---- */

bool overlay_on_tools(const struct overlay *overlay, float x_px, float y_px)
{
	for (int tool = 0; tool < OVERLAY_TOOL_COUNT; tool++)
		if (overlay_tool_shows(overlay, tool) &&
		    rect_holds(overlay_tool_rect(overlay, tool), x_px, y_px))
			return true;
	return false;
}

enum overlay_handle overlay_handle_at(const struct overlay *overlay, float x_px, float y_px)
{
	const struct screen screen = overlay_screen(overlay);
	float x, y, radius;

	if (overlay->question.on ||
	    (overlay->languages_view.fade.on &&
	     rect_holds(languages_view_rect(&screen, &overlay->languages), x_px, y_px)))
		return OVERLAY_HANDLE_NONE;
	for (int tool = 0; tool < OVERLAY_TOOL_COUNT; tool++) {
		if (!overlay_tool_shows(overlay, tool))
			continue;
		ring_of(overlay, tool, &x, &y, &radius);
		const float far = hypotf(x_px - x, y_px - y);

		if (far > (float)disc_px(overlay) / 2)
			continue;
		if (tool_bits[tool] == OVERLAY_TOOL_LIGHT)
			return OVERLAY_HANDLE_LIGHT;
		return far > radius - (float)px(overlay, THEME_TARGET_MM) / 2 ? OVERLAY_HANDLE_TURN
									      : OVERLAY_HANDLE_PUSH;
	}
	return OVERLAY_HANDLE_NONE;
}

void overlay_handle_place(const struct overlay *overlay, enum overlay_handle handle, float x_px,
			  float y_px, float at[2])
{
	float x, y, radius;

	ring_of(overlay, handle == OVERLAY_HANDLE_LIGHT ? 0 : 1, &x, &y, &radius);
	at[0] = (x_px - x) / radius;
	at[1] = (y - y_px) / radius;
}

/* ---- bitmaps ---- */

static void draw_disc(struct overlay *overlay, int tool)
{
	/* Translators: two tools: light from the side, which shows relief, and a cut model. */
	static const char *const names[OVERLAY_TOOL_COUNT] = { N_("Raking light"),
							       N_("Cross-section") };
	const struct rect rect = overlay_tool_rect(overlay, tool);
	const enum bitmap_id id = (enum bitmap_id)(BITMAP_DISC + tool);
	cairo_t *context = overlay_begin(overlay, id, rect.width_px, rect.height_px);
	const double turn = 4 * acos(0.0), line = px(overlay, 0.35f);
	const int padding = px(overlay, PADDING_MM);
	float x, y, radius;
	int height_px;
	PangoLayout *layout;

	if (!context)
		return;
	ring_of(overlay, tool, &x, &y, &radius);
	x -= (float)rect.x_px;
	y -= (float)rect.y_px;
	theme_rounded(context, 0, 0, rect.width_px, rect.height_px, px(overlay, THEME_RADIUS_MM));
	theme_set_source(context, theme_night, THEME_CHIP_ALPHA);
	cairo_fill(context);
	layout = theme_layout(&overlay->theme, TEXT_BUTTON,
			      translate(overlay->theme.language, names[tool]), -1);
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
		const double side = px(overlay, 1.6f), foot = (double)(y + radius) - 3 * line;

		theme_set_source(context, theme_night_text, THEME_DIM_ALPHA);
		cairo_move_to(context, (double)x - side, foot);
		cairo_line_to(context, (double)x, foot - 1.4 * side);
		cairo_line_to(context, (double)x + side, foot);
		cairo_close_path(context);
		cairo_fill(context);
	}
	overlay_end(overlay, id, context);
}

static void draw_knob(struct overlay *overlay, enum bitmap_id id, struct colour colour,
		      bool has_arrows)
{
	const int side = px(overlay, THEME_TARGET_MM);
	const double middle = side / 2.0, turn = 4 * acos(0.0);
	cairo_t *context = overlay_begin(overlay, id, side, side);

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
	overlay_end(overlay, id, context);
}

static void draw_line(struct overlay *overlay)
{
	const int thick = px(overlay, LINE_MM);
	cairo_t *context = overlay_begin(overlay, BITMAP_CUT, 8, thick);

	if (!context)
		return;
	theme_set_source(context, theme_accent, 1);
	cairo_paint(context);
	overlay_end(overlay, BITMAP_CUT, context);
}

bool overlay_update_tools(struct overlay *overlay, int64_t step_ms)
{
	struct tools_panel *tools = &overlay->tools;
	const struct rect rect = overlay_tool_rect(overlay, 0);
	bool moving = false;

	if (!tools->offered)
		return false;
	tools->dirty |=
		rect.width_px != tools->drawn.width_px || rect.height_px != tools->drawn.height_px;
	for (int tool = 0; tool < OVERLAY_TOOL_COUNT; tool++) {
		const bool shows = overlay_tool_shows(overlay, tool);

		overlay->callouts_dirty |= shows != tools->fade[tool].on;
		tools->fade[tool].on = shows;
		moving |= fade_advance(&tools->fade[tool], step_ms);
	}
	if (tools->dirty && tools->now.on) {
		tools->drawn = rect;
		for (int tool = 0; tool < OVERLAY_TOOL_COUNT; tool++)
			draw_disc(overlay, tool);
		draw_knob(overlay, BITMAP_KNOB, theme_night_text, false);
		draw_knob(overlay, BITMAP_PUSH, theme_accent, true);
		draw_line(overlay);
		tools->dirty = false;
	}
	return moving;
}

/* Sets the centres of the knobs, pixels of the panel. The push knob is turned along along[]. */
void overlay_tool_knobs(const struct overlay *overlay, struct overlay_knobs *out)
{
	const struct overlay_tools *now = &overlay->tools.now;
	const float right = -sinf(now->turn_rad), up = cosf(now->turn_rad);
	float x, y, radius;

	ring_of(overlay, 0, &x, &y, &radius);
	out->light[0] = x + now->light_at[0] * radius;
	out->light[1] = y - now->light_at[1] * radius;
	ring_of(overlay, 1, &x, &y, &radius);
	out->turn[0] = x + right * radius;
	out->turn[1] = y - up * radius;
	out->along[0] = right;
	out->along[1] = -up;
	out->push[0] = x + right * radius * now->push;
	out->push[1] = y - up * radius * now->push;
	out->line_px = radius * sqrtf(fmaxf(1 - now->push * now->push, 0.02f));
	out->thick_px = (float)px(overlay, LINE_MM) / 2;
}
