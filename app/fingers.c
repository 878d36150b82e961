/* Routes each touch to the module that handles it, or to the gesture recogniser, whose gestures
 * move the eye or what the overlay shows. */
#include "app/fingers.h"

#include <math.h>

#include "base/clock.h"
#include "base/log.h"

#define SLOP_MM    3
#define NEAR_MM    10
#define WHEEL_STEP 1.12f

static struct overlay *overlay_of(const struct fingers *fingers)
{
	return exhibit_overlay(fingers->env.shown);
}

static void grab(struct fingers *fingers, float x_px, float y_px)
{
	tour_player_halt(fingers->env.tours);
	eye_grab(fingers->env.eye, fingers->env.viewport, x_px, y_px);
}

/* ---- scenery that a finger drags */

static void hold(struct fingers *fingers, float x_px, float y_px)
{
	struct scene *scene = fingers->env.shown->scene;

	viewport_to_panel(fingers->env.viewport, &x_px, &y_px);
	fingers->holds = scene && scene_grab(scene, &fingers->env.eye->camera, x_px, y_px);
	if (fingers->holds)
		log_debug("app", "the scenery is held");
}

static void pull(struct fingers *fingers, float x_px, float y_px)
{
	struct scene *scene = fingers->env.shown->scene;

	viewport_to_panel(fingers->env.viewport, &x_px, &y_px);
	if (scene)
		scene_drag(scene, &fingers->env.eye->camera, x_px, y_px);
}

/* Returns whether something was held. */
static bool let_go(struct fingers *fingers)
{
	const bool held = fingers->holds;

	if (held && fingers->env.shown->scene)
		scene_let_go(fingers->env.shown->scene);
	if (held)
		log_debug("app", "the scenery is let go");
	fingers->holds = false;
	return held;
}

/* ---- gestures */

static void on_press(struct fingers *fingers, const struct gesture *gesture)
{
	const struct overlay *overlay = overlay_of(fingers);

	fingers->on_words = overlay && overlay_covers(overlay, gesture->x_px, gesture->y_px);
	if (!fingers->on_words)
		grab(fingers, gesture->x_px, gesture->y_px);
}

/* Whether a tap is meant that lands on this. Many visitors tap a control twice: the second tap
 * would undo what the first has done, or hit what lay under it. */
static bool is_meant(struct fingers *fingers, enum gesture_kind gesture,
		     enum overlay_action_kind kind)
{
	const enum overlay_action_kind before = fingers->tapped;

	fingers->tapped = kind;
	/* Beside a control nothing was done: who missed it taps again at once. */
	if (gesture == GESTURE_TAP || before == OVERLAY_NONE || before == OVERLAY_SWALLOWED)
		return true;
	return kind == before &&
	       (kind == OVERLAY_KEY || kind == OVERLAY_BACK || kind == OVERLAY_PICTURE);
}

static void on_tap(struct fingers *fingers, const struct gesture *gesture)
{
	const struct actions *actions = fingers->env.actions;
	struct overlay *overlay = overlay_of(fingers);
	struct overlay_action action;

	if (!overlay)
		return;
	action = overlay_tap(overlay, gesture->x_px, gesture->y_px);
	if (!is_meant(fingers, gesture->kind, action.kind))
		return;
	if (action.kind == OVERLAY_SWALLOWED && gesture->kind == GESTURE_DOUBLE_TAP &&
	    overlay_picture(overlay) >= 0)
		overlay_picture_double_tap(overlay, gesture->x_px, gesture->y_px);
	else if (action.kind != OVERLAY_NONE)
		actions_carry_out(actions, &action);
	else if (tools_take_tap(fingers->env.tools, gesture->x_px, gesture->y_px))
		return;
	else if (gesture->kind == GESTURE_TAP)
		actions_show_part_at(actions, gesture->x_px, gesture->y_px);
	else
		actions_open_part_at(actions, gesture->x_px, gesture->y_px);
}

static void on_picture(struct overlay *overlay, const struct gesture *gesture)
{
	switch (gesture->kind) {
	case GESTURE_DRAG:
		overlay_picture_drag(overlay, gesture->dx_px, gesture->dy_px);
		break;
	case GESTURE_DRAG_END:
	case GESTURE_CANCEL:
		overlay_picture_drag_end(overlay, gesture->vx_px_per_s);
		break;
	case GESTURE_PINCH:
		overlay_picture_pinch(overlay, gesture->x_px, gesture->y_px, gesture->scale,
				      gesture->dx_px, gesture->dy_px);
		break;
	default:
		break;
	}
}

static void on_words(struct fingers *fingers, const struct gesture *gesture)
{
	struct overlay *overlay = overlay_of(fingers);

	if (overlay_picture(overlay) >= 0) {
		on_picture(overlay, gesture);
		return;
	}
	if (gesture->kind == GESTURE_DRAG)
		overlay_scroll(overlay, gesture->dy_px);
	else if (gesture->kind == GESTURE_DRAG_END)
		overlay_fling(overlay, gesture->vy_px_per_s);
}

/* Logs the eye, twice per gesture, to help find out what fingers did on a panel. */
static void on_model(struct fingers *fingers, const struct gesture *gesture)
{
	const float height = (float)viewport_height_px(fingers->env.viewport);
	struct eye *eye = fingers->env.eye;
	struct overlay *overlay = overlay_of(fingers);

	switch (gesture->kind) {
	case GESTURE_DRAG_BEGIN:
	case GESTURE_PINCH_BEGIN:
		eye_log(eye, gesture->kind == GESTURE_DRAG_BEGIN ? "drag begins" : "pinch begins");
		grab(fingers, gesture->x_px, gesture->y_px);
		if (overlay)
			overlay_show_help(overlay, false);
		if (gesture->kind == GESTURE_DRAG_BEGIN)
			hold(fingers, gesture->x_px, gesture->y_px);
		break;
	case GESTURE_DRAG:
		if (fingers->holds)
			pull(fingers, gesture->x_px, gesture->y_px);
		else
			navigator_turn(&eye->navigator, gesture->dx_px, gesture->dy_px, height);
		break;
	case GESTURE_DRAG_END:
		if (!let_go(fingers))
			navigator_fling(&eye->navigator, gesture->vx_px_per_s,
					gesture->vy_px_per_s);
		eye_log(eye, "drag ends");
		break;
	case GESTURE_PINCH:
		navigator_pinch(&eye->navigator, gesture->scale, gesture->dx_px, gesture->dy_px,
				gesture->turn_rad, height);
		break;
	case GESTURE_PINCH_END:
		eye_log(eye, "pinch ends");
		break;
	case GESTURE_CANCEL:
		let_go(fingers);
		break;
	default:
		break;
	}
}

static void on_gesture(void *data, const struct gesture *gesture)
{
	struct fingers *fingers = data;

	if (!fingers->env.eye->ready)
		return; /* nothing can be touched yet */
	redraw_ask(fingers->env.redraw);
	if (gesture->kind == GESTURE_PRESS)
		on_press(fingers, gesture);
	else if (gesture->kind == GESTURE_TAP || gesture->kind == GESTURE_DOUBLE_TAP)
		on_tap(fingers, gesture);
	else if (fingers->on_words)
		on_words(fingers, gesture);
	else
		on_model(fingers, gesture);
}

void fingers_init(struct fingers *fingers, const struct fingers_env *env)
{
	const struct gesture_options options = {
		.slop_px = SLOP_MM * env->viewport->px_per_mm,
		.near_px = NEAR_MM * env->viewport->px_per_mm,
		.gesture = on_gesture,
		.data = fingers,
	};

	*fingers = (struct fingers){ .env = *env };
	gesture_init(&fingers->gestures, &options);
}

void fingers_reset(struct fingers *fingers)
{
	gesture_reset(&fingers->gestures);
	let_go(fingers);
	fingers->on_keys = 0;
}

/* ---- touches */

/* Handles the on-screen keyboard. A key acts when the finger comes down, each finger separately:
 * two typing fingers are not a pinch, and a finger that slides off has still typed. Returns true if
 * the finger belongs to a key until it lifts. */
static bool types(struct fingers *fingers, const struct touch_event *event)
{
	const struct overlay *overlay = overlay_of(fingers);
	const uint32_t finger = 1u << event->contact;
	struct overlay_action action;

	if (event->phase != TOUCH_DOWN) {
		const bool is_typing = fingers->on_keys & finger;

		if (event->phase != TOUCH_MOVE)
			fingers->on_keys &= ~finger;
		return is_typing;
	}
	if (!overlay || !fingers->env.eye->ready)
		return false;
	action = overlay_tap(overlay, event->x_px, event->y_px);
	if (action.kind != OVERLAY_KEY || action.key == OVERLAY_KEY_CLEAR)
		return false;
	fingers->on_keys |= finger;
	actions_press_key(fingers->env.actions, action.key);
	redraw_ask(fingers->env.redraw);
	return true;
}

void fingers_on_touch(void *data, const struct touch_event *event)
{
	struct fingers *fingers = data;
	const struct fingers_env *env = &fingers->env;
	struct touch_event seen = *event;

	if (panel_take_touch(env->panel, event) || setup_page_covers(env->setup_page))
		return; /* the touch only woke the panel, or the setup page is shown */
	if (visitor_take_touch(env->visitor, event))
		return;
	viewport_unshift(env->viewport, &seen.x_px, &seen.y_px);
	if (!tools_take_touch(env->tools, &seen) && !types(fingers, &seen))
		gesture_feed(&fingers->gestures, &seen);
}

/* ---- the pointer of a window */

/* A wheel step acts as a pinch: on the picture if one is shown, otherwise on the model. */
static void turn_wheel(struct fingers *fingers, float x_px, float y_px, float scale)
{
	struct overlay *overlay = overlay_of(fingers);

	if (overlay && overlay_picture(overlay) >= 0) {
		overlay_picture_pinch(overlay, x_px, y_px, scale, 0, 0);
	} else {
		grab(fingers, x_px, y_px);
		navigator_pinch(&fingers->env.eye->navigator, scale, 0, 0, 0,
				(float)viewport_height_px(fingers->env.viewport));
	}
	redraw_ask(fingers->env.redraw);
}

void fingers_on_pointer(void *data, enum pointer_kind kind, float x_px, float y_px, float steps)
{
	static const enum touch_phase phases[] = {
		[POINTER_MOVE] = TOUCH_MOVE,
		[POINTER_DOWN] = TOUCH_DOWN,
		[POINTER_UP] = TOUCH_UP,
	};
	struct fingers *fingers = data;

	if (setup_page_covers(fingers->env.setup_page))
		return;
	viewport_from_panel(fingers->env.viewport, &x_px, &y_px);
	if (kind == POINTER_WHEEL) {
		visitor_stay(fingers->env.visitor);
		if (fingers->env.eye->ready)
			turn_wheel(fingers, x_px, y_px, powf(WHEEL_STEP, steps));
		return;
	}
	if (kind == POINTER_MOVE && !fingers->gestures.fingers[0].down &&
	    fingers->env.tools->held == OVERLAY_HANDLE_NONE)
		return;
	fingers_on_touch(fingers, &(struct touch_event){
					  .phase = phases[kind],
					  .x_px = x_px,
					  .y_px = y_px,
					  .time_us = clock_now_us(),
				  });
}
