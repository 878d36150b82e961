/* Handles the visitor's tools, the raking light, the section, measuring and walking: switches them
 * on and off, moves them with a finger, and passes them to scene and overlay. */
#include "app/visit/tools.h"

#include <math.h>
#include <string.h>

#include "base/log.h"
#include "storage/info_tools.h"

/* The first position of the raking light on its disc: from the upper left, as is usual in drawings,
 * and low. */
static const float first_light[2] = { -0.62f, 0.52f };

/* Returns the eye's heading about the vertical axis, in radians. On the discs, up points away from
 * the eye. */
static float heading(const struct tools *tools)
{
	const float *eye = tools->env.eye->camera.eye_m, *target = tools->env.eye->camera.target_m;

	return atan2f(target[1] - eye[1], target[0] - eye[0]);
}

static unsigned offered(const struct tools *tools)
{
	const struct overlay *overlay = exhibit_overlay(tools->env.shown);

	return overlay ? overlay_tools_offered(overlay) : 0;
}

static float scan_error_m(const struct tools *tools)
{
	const struct info *info = exhibit_info(tools->env.shown);

	return info ? info_scan_error_m(info) : 0;
}

static void log_state(const struct tools *tools)
{
	const struct rake *rake = &tools->now.rake;
	const struct section *section = &tools->now.section;

	if (rake->on)
		log_debug("app", "light at %.2f %.2f", (double)rake->at[0], (double)rake->at[1]);
	if (section->on)
		log_debug("app", "section at %.2f m, turned %.2f", (double)section->push_m,
			  (double)section->turn_rad);
	if (tools->measure.on && tools->measure.count == 2)
		log_debug("app", "measured %.3f m, off by %.3f m",
			  (double)measuring_length_m(&tools->measure),
			  (double)measuring_error_m(&tools->measure, scan_error_m(tools)));
	else if (tools->walks)
		log_debug("app", "on foot");
	else if (tools->measure.on)
		log_debug("app", "measuring, %u ends", tools->measure.count);
	if (!tools_are_used(tools))
		log_debug("app", "no tools");
}

static void let_go(struct tools *tools)
{
	tools->held = OVERLAY_HANDLE_NONE;
}

void tools_init(struct tools *tools, const struct tools_env *env)
{
	*tools = (struct tools){ .env = *env };
}

static void switch_section_on(struct tools *tools)
{
	const struct eye *eye = tools->env.eye;
	const struct navigator_options *o = &eye->navigator.options;
	float forward[3];

	for (int k = 0; k < 3; k++)
		forward[k] = eye->camera.target_m[k] - eye->camera.eye_m[k];
	const float far = hypotf(hypotf(forward[0], forward[1]), forward[2]);
	for (int k = 0; k < 3 && far > 0; k++)
		forward[k] /= far;
	section_init(&tools->now.section, o->box_min_m, o->box_max_m);
	section_face(&tools->now.section, eye->camera.eye_m, forward);
}

/* The section changes what hides an anchor. */
static void changed(struct tools *tools)
{
	anchors_test_again(tools->env.anchors);
	redraw_ask(tools->env.redraw);
}

void tools_press(struct tools *tools, enum overlay_tool tool)
{
	struct scene_tools *now = &tools->now;

	let_go(tools);
	if (tool == OVERLAY_TOOL_LIGHT) {
		now->rake.on = !now->rake.on;
		rake_place(&now->rake, first_light[0], first_light[1]);
	} else if (tool == OVERLAY_TOOL_MEASURE) {
		tools->measure = (struct measuring){ .on = !tools->measure.on };
		tools->walks = false; /* a tap can mean one of the two */
	} else if (tool == OVERLAY_TOOL_WALK) {
		tools->walks = !tools->walks;
		tools->measure.on = false;
		tools->no_way = false;
	} else if (now->section.on) {
		now->section.on = false;
	} else {
		switch_section_on(tools);
	}
	log_state(tools);
	changed(tools);
}

bool tools_are_used(const struct tools *tools)
{
	return tools->now.rake.on || tools->now.section.on || tools->measure.on || tools->walks;
}

void tools_end(struct tools *tools)
{
	let_go(tools);
	if (!tools_are_used(tools))
		return;
	tools->now.rake.on = tools->now.section.on = false;
	tools->measure = (struct measuring){ 0 };
	tools->walks = false;
	navigator_set_on_foot(&tools->env.eye->navigator, false);
	log_state(tools);
	redraw_ask(tools->env.redraw);
}

/* ---- fingers */

/* Returns where an end is for the visitor; false: it is out of sight. */
static bool end_on_panel(const struct tools *tools, int end, float at_px[2])
{
	if (!camera_pixel(&tools->env.eye->camera, tools->measure.ends[end].at_m, &at_px[0],
			  &at_px[1]))
		return false;
	viewport_from_panel(tools->env.viewport, &at_px[0], &at_px[1]);
	return true;
}

static bool is_end(enum overlay_handle handle)
{
	return handle == OVERLAY_HANDLE_FROM || handle == OVERLAY_HANDLE_TO;
}

static void grab(struct tools *tools, uint32_t contact, enum overlay_handle handle,
		 const float at[2])
{
	float end_px[2];

	tools->held = handle;
	tools->contact = contact;
	memcpy(tools->grabbed_at, at, sizeof(tools->grabbed_at));
	tools->grabbed_push_m = tools->now.section.push_m;
	if (is_end(handle) && end_on_panel(tools, handle == OVERLAY_HANDLE_TO, end_px)) {
		tools->grabbed_at[0] -= end_px[0];
		tools->grabbed_at[1] -= end_px[1];
	}
}

static void move_end(struct tools *tools, const float at[2])
{
	const int end = tools->held == OVERLAY_HANDLE_TO;
	struct measured_end found;

	if (eye_measure(tools->env.eye, tools->env.viewport, at[0] - tools->grabbed_at[0],
			at[1] - tools->grabbed_at[1], found.at_m, &found.error_m))
		tools->measure.ends[end] = found;
}

static void move(struct tools *tools, const float at[2])
{
	struct section *section = &tools->now.section;
	const float turn = section->turn_rad - heading(tools);

	switch (tools->held) {
	case OVERLAY_HANDLE_NONE:
		break;
	case OVERLAY_HANDLE_LIGHT:
		rake_place(&tools->now.rake, at[0], at[1]);
		break;
	case OVERLAY_HANDLE_TURN:
		if (hypotf(at[0], at[1]) > 0.1f)
			section_turn(section, heading(tools) + atan2f(-at[0], at[1]));
		break;
	case OVERLAY_HANDLE_PUSH:
		/* Moves the section as far as the finger moved along its normal. */
		section->push_m = tools->grabbed_push_m;
		section_push(section,
			     section->reach_m * ((at[1] - tools->grabbed_at[1]) * cosf(turn) -
						 (at[0] - tools->grabbed_at[0]) * sinf(turn)));
		break;
	case OVERLAY_HANDLE_FROM:
	case OVERLAY_HANDLE_TO:
		move_end(tools, at);
		break;
	}
	changed(tools);
}

/* Where a finger is, as its handle counts: on a disc, or on the panel. */
static void place_finger(const struct tools *tools, enum overlay_handle handle,
			 const struct touch_event *event, float at[2])
{
	if (is_end(handle)) {
		at[0] = event->x_px;
		at[1] = event->y_px;
		return;
	}
	overlay_handle_place(exhibit_overlay(tools->env.shown), handle, event->x_px, event->y_px,
			     at);
}

static void walk_to(struct tools *tools, float x_px, float y_px)
{
	float at_m[3];

	tools->no_way = !eye_pick(tools->env.eye, tools->env.viewport, x_px, y_px, at_m) ||
			!navigator_walk(&tools->env.eye->navigator, at_m);
	log_debug("app", tools->no_way ? "no way on foot" : "walks");
	redraw_ask(tools->env.redraw);
}

bool tools_take_tap(struct tools *tools, float x_px, float y_px)
{
	struct measured_end end;

	if (tools->walks)
		walk_to(tools, x_px, y_px);
	if (!tools->measure.on)
		return tools->walks;
	if (eye_measure(tools->env.eye, tools->env.viewport, x_px, y_px, end.at_m, &end.error_m)) {
		measuring_add(&tools->measure, &end);
		log_state(tools);
		redraw_ask(tools->env.redraw);
	}
	return true;
}

bool tools_take_touch(struct tools *tools, const struct touch_event *event)
{
	struct overlay *overlay = exhibit_overlay(tools->env.shown);
	const bool is_holder =
		tools->held != OVERLAY_HANDLE_NONE && tools->contact == event->contact;
	enum overlay_handle handle;
	float at[2];

	if (!overlay || !tools->env.eye->ready)
		return false;
	if (event->phase == TOUCH_DOWN) {
		handle = overlay_handle_at(overlay, event->x_px, event->y_px);
		if (handle == OVERLAY_HANDLE_NONE || tools->held != OVERLAY_HANDLE_NONE)
			return false;
		place_finger(tools, handle, event, at);
		grab(tools, event->contact, handle, at);
		if (!is_end(handle))
			move(tools, at);
		return true;
	}
	if (!is_holder)
		return false;
	if (event->phase == TOUCH_MOVE) {
		place_finger(tools, tools->held, event, at);
		move(tools, at);
		return true;
	}
	let_go(tools);
	log_state(tools);
	return true;
}

/* ---- a frame */

static struct overlay_measure measure_shown(const struct tools *tools)
{
	const struct measuring *measure = &tools->measure;
	const struct rect scene = overlay_scene_rect(exhibit_overlay(tools->env.shown));
	struct overlay_measure shown = { .count = measure->count };

	for (unsigned end = 0; end < measure->count; end++) {
		float *at = shown.at_px[end];

		shown.in_sight[end] = end_on_panel(tools, (int)end, at) &&
				      section_keeps(&tools->now.section, measure->ends[end].at_m) &&
				      rect_holds(scene, at[0], at[1]);
	}
	if (measure->count == 2) {
		shown.length_m = measuring_length_m(measure);
		shown.error_m = measuring_error_m(measure, scan_error_m(tools));
	}
	return shown;
}

void tools_show(struct tools *tools)
{
	struct overlay *overlay = exhibit_overlay(tools->env.shown);
	struct scene_tools *now = &tools->now;

	/* Another release may offer other tools. */
	now->rake.on = now->rake.on && offered(tools) & OVERLAY_TOOL_LIGHT;
	now->section.on = now->section.on && offered(tools) & OVERLAY_TOOL_SECTION;
	tools->measure.on = tools->measure.on && offered(tools) & OVERLAY_TOOL_MEASURE;
	tools->walks = tools->walks && offered(tools) & OVERLAY_TOOL_WALK;
	navigator_set_on_foot(&tools->env.eye->navigator, tools->walks);
	if (tools->env.shown->scene)
		scene_use(tools->env.shown->scene, now);
	if (overlay)
		overlay_show_tools(
			overlay,
			&(struct overlay_tools){
				.on = (now->rake.on ? OVERLAY_TOOL_LIGHT : 0u) |
				      (now->section.on ? OVERLAY_TOOL_SECTION : 0u) |
				      (tools->measure.on ? OVERLAY_TOOL_MEASURE : 0u) |
				      (tools->walks ? OVERLAY_TOOL_WALK : 0u),
				.measure = measure_shown(tools),
				.no_way = tools->no_way,
				.light_at = { now->rake.at[0], now->rake.at[1] },
				.turn_rad = now->section.turn_rad - heading(tools),
				.push = now->section.on ? now->section.push_m / now->section.reach_m
							: 0,
			});
}
