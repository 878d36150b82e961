/* Gives touches and gestures their meaning: on the model they move the eye; on the overlay they
 * open, close, scroll and type. Also starts the camera flights that taps ask for. */
#include <errno.h>
#include <math.h>
#include <string.h>

#include <cglm/cglm.h>

#include "app/kiosk.h"
#include "base/clock.h"
#include "base/log.h"

#define FLIGHT_MS        900
#define PART_LEAST_M     0.5f  /* smallest size of a part for a flight to it */
#define PART_LEAST_SHARE 0.03f /* on a small model: a share of its diagonal */
#define SLOP_MM          3
#define NEAR_MM          10
#define WHEEL_STEP       1.12f

/* Finds the surface point under a finger. If the ray hits nothing, point_m is the point on the ray
 * at the distance of the model's centre, and the result is false. */
static bool pick(struct kiosk *kiosk, float x_px, float y_px, float point_m[3])
{
	const struct navigator_options *o = &kiosk->navigator.options;
	float direction[3], middle[3];

	viewport_to_panel(kiosk, &x_px, &y_px);
	if (scene_pick(kiosk->shown.scene, &kiosk->camera, x_px, y_px, point_m))
		return true;
	camera_ray(&kiosk->camera, x_px, y_px, direction);
	glm_vec3_lerp((float *)o->box_min_m, (float *)o->box_max_m, 0.5f, middle);
	glm_vec3_copy(kiosk->camera.eye_m, point_m);
	glm_vec3_muladds(
		direction,
		fmaxf(navigator_keep_off_m(&kiosk->navigator), glm_vec3_distance(middle, point_m)),
		point_m);
	return false;
}

static void grab(struct kiosk *kiosk, float x_px, float y_px)
{
	float pivot[3];

	tour_player_halt(kiosk);
	pick(kiosk, x_px, y_px, pivot);
	navigator_grab(&kiosk->navigator, pivot);
}

/* ---- flights */

/* Flies to a pose in which the part is in the middle of the area that the overlay leaves free. */
static void fly_to_part(struct kiosk *kiosk, uint32_t part)
{
	const struct rect rect = overlay_scene_rect(information_view_overlay(kiosk->shown.view));
	const float w = (float)kiosk_width_px(kiosk), h = (float)kiosk_height_px(kiosk);
	const float tangent = tanf(glm_rad(kiosk->navigator.options.fov_deg) / 2);
	const float side = ((float)rect.x_px + (float)rect.width_px / 2) / w * 2 - 1;
	const float height = 1 - ((float)rect.y_px + (float)rect.height_px / 2) / h * 2;
	const float least =
		fminf(PART_LEAST_M, PART_LEAST_SHARE * navigator_diagonal_m(&kiosk->navigator));
	float eye[3], target[3], forward[3], right[3], up[3], distance;

	information_view_viewpoint(kiosk->shown.view, part, least, kiosk->navigator.eye_m, eye,
				   target);
	glm_vec3_sub(target, eye, forward);
	distance = glm_vec3_norm(forward);
	glm_vec3_cross(forward, (vec3){ 0, 0, 1 }, right);
	glm_vec3_normalize(right);
	glm_vec3_cross(right, forward, up);
	glm_vec3_normalize(up);
	glm_vec3_muladds(right, -side * tangent * w / h * distance, target);
	glm_vec3_muladds(up, -height * tangent * distance, target);
	navigator_fly(&kiosk->navigator, eye, target, FLIGHT_MS);
}

static void go_home(struct kiosk *kiosk)
{
	const struct navigator_options *o = &kiosk->navigator.options;

	navigator_fly(&kiosk->navigator, o->home_eye_m, o->home_target_m, FLIGHT_MS);
}

static void show_card(struct kiosk *kiosk, int part)
{
	if (part >= 0) {
		log_debug("app", "card of %s",
			  info_part(information_view_info(kiosk->shown.view), (uint32_t)part)->id);
		counting_part(kiosk, USAGE_PART, part);
	}
	overlay_show_card(information_view_overlay(kiosk->shown.view), part);
}

static void open_page(struct kiosk *kiosk, int part)
{
	if (part >= 0 && information_view_open_page(kiosk->shown.view, (uint32_t)part)) {
		log_debug("app", "page of %s",
			  info_part(information_view_info(kiosk->shown.view), (uint32_t)part)->id);
		counting_part(kiosk, USAGE_PAGE, part);
		show_card(kiosk, -1);
		fly_to_part(kiosk, (uint32_t)part);
	}
}

/* Closes the page. Its part was in the middle of the area beside the page; if nobody has moved the
 * eye since, flies so that the part is in the middle of the whole panel. */
static void close_page(struct kiosk *kiosk)
{
	struct overlay *overlay = information_view_overlay(kiosk->shown.view);
	const int part = overlay_page(overlay);

	overlay_close_page(overlay);
	if (part >= 0 && navigator_is_left_alone(&kiosk->navigator))
		fly_to_part(kiosk, (uint32_t)part);
}

/* ---- taps */

/* Returns the part under a finger, or -1. Uses the labels of the release; if they are not loaded,
 * the regions of the parts. */
static int part_under(struct kiosk *kiosk, float x_px, float y_px)
{
	const struct info *info = information_view_info(kiosk->shown.view);
	float point[3];
	const char *id;

	if (!info || !pick(kiosk, x_px, y_px, point))
		return -1;
	viewport_to_panel(kiosk, &x_px, &y_px);
	id = scene_part(kiosk->shown.scene, &kiosk->camera, x_px, y_px);
	if (!id)
		return information_view_part_at(kiosk->shown.view, point);
	return *id ? info_find(info, id) : -1;
}

static void tap_model(struct kiosk *kiosk, float x_px, float y_px)
{
	const int part = part_under(kiosk, x_px, y_px);

	if (part >= 0 && part != overlay_card(information_view_overlay(kiosk->shown.view)))
		back_note(kiosk);
	show_card(kiosk, part);
}

/* Follows a link of a page: starts the tour, or opens the part's page. A part without a page is
 * shown on the model, and the open page stays. */
static void follow_link(struct kiosk *kiosk, const char *link)
{
	const struct info *info = information_view_info(kiosk->shown.view);
	int part;

	if (strncmp(link, "tour:", 5) == 0) {
		tour_player_start(kiosk, info_find_tour(info, link + 5));
		return;
	}
	part = info_find(info, link);
	if (part >= 0 && !info_part(info, (uint32_t)part)->has_page) {
		show_card(kiosk, part);
		fly_to_part(kiosk, (uint32_t)part);
		return;
	}
	open_page(kiosk, part);
}

/* The log gets only the number of bytes typed, not the text, which is private. The number is enough
 * to test keyboards. */
static void press_key(struct kiosk *kiosk, int key)
{
	struct overlay *overlay = information_view_overlay(kiosk->shown.view);

	if (!overlay_press(overlay, key))
		return;
	information_view_search(kiosk->shown.view);
	log_debug("app", "search: %zu bytes typed", strlen(overlay_query(overlay)));
}

/* Switches large text or easy reach on or off. Easy reach moves the page, so the area left for the
 * model may change; the part is then centred again. */
static void change_comfort(struct kiosk *kiosk, enum overlay_action_kind which)
{
	struct overlay *overlay = information_view_overlay(kiosk->shown.view);
	struct overlay_comfort comfort = overlay_comfort(overlay);

	if (which == OVERLAY_LARGE)
		comfort.large = !comfort.large;
	else
		comfort.reach = !comfort.reach;
	overlay_set_comfort(overlay, comfort);
	log_debug("app", "comfort:%s%s", comfort.large ? " large" : "",
		  comfort.reach ? " reach" : "");
	if (which == OVERLAY_REACH && overlay_page(overlay) >= 0)
		fly_to_part(kiosk, (uint32_t)overlay_page(overlay));
}

/* Returns whether the action halts a tour: it opens something to read or leads elsewhere, which
 * does not fit a moving camera. */
static bool halts_tour(enum overlay_action_kind kind)
{
	return kind == OVERLAY_OPEN_CARD || kind == OVERLAY_OPEN_PAGE || kind == OVERLAY_SEARCH ||
	       kind == OVERLAY_HELP || kind == OVERLAY_LINK || kind == OVERLAY_FOUND;
}

/* Returns whether the action is a step that the back button can undo. An action that only closes
 * something is no step. */
static bool is_step(const struct kiosk *kiosk, enum overlay_action_kind kind)
{
	const struct overlay *overlay = information_view_overlay(kiosk->shown.view);

	switch (kind) {
	case OVERLAY_OPEN_CARD:
	case OVERLAY_OPEN_PAGE:
	case OVERLAY_LINK:
	case OVERLAY_FOUND:
	case OVERLAY_TOUR:
	case OVERLAY_HOME:
		return true;
	case OVERLAY_SEARCH:
		return !overlay_searching(overlay);
	case OVERLAY_TOURS:
		return !overlay_choosing(overlay) &&
		       (kiosk->tour.state == TOUR_OFF || kiosk->tour.loops);
	default:
		return false;
	}
}

static void carry_out(struct kiosk *kiosk, const struct overlay_action *action)
{
	struct overlay *overlay = information_view_overlay(kiosk->shown.view);
	const bool chose_language = overlay_choosing_language(overlay);

	if (is_step(kiosk, action->kind))
		back_note(kiosk);
	if (halts_tour(action->kind))
		tour_player_halt(kiosk);
	if (action->kind != OVERLAY_LANGUAGES && action->kind != OVERLAY_NONE)
		overlay_show_languages(overlay, false);
	switch (action->kind) {
	case OVERLAY_NONE:
	case OVERLAY_SWALLOWED:
		break;
	case OVERLAY_OPEN_CARD:
		show_card(kiosk, action->part);
		break;
	case OVERLAY_OPEN_PAGE:
		open_page(kiosk, action->part);
		break;
	case OVERLAY_CLOSE_CARD:
		show_card(kiosk, -1);
		break;
	case OVERLAY_CLOSE_PAGE:
		close_page(kiosk);
		break;
	case OVERLAY_WIDEN_PAGE:
		overlay_widen_page(overlay, !overlay_page_is_wide(overlay));
		log_debug("app", "page: %s",
			  overlay_page_is_wide(overlay) ? "over the whole panel"
							: "beside the model");
		break;
	case OVERLAY_LANGUAGE:
		information_view_set_language(kiosk->shown.view, action->language);
		counting_part(kiosk, USAGE_LANGUAGE, -1);
		break;
	case OVERLAY_LANGUAGES:
		overlay_show_languages(overlay, !overlay_choosing_language(overlay));
		break;
	case OVERLAY_LINK:
		follow_link(kiosk, action->link);
		break;
	case OVERLAY_TOURS:
		tour_player_press(kiosk);
		break;
	case OVERLAY_TOUR:
		tour_player_start(kiosk, action->tour);
		break;
	case OVERLAY_TOUR_PAUSE:
		tour_player_press(kiosk);
		break;
	case OVERLAY_TOUR_CLOSE:
		tour_player_end(kiosk);
		break;
	case OVERLAY_HOME:
		tour_player_end(kiosk);
		overlay_show_tours(overlay, false);
		overlay_close_page(overlay);
		overlay_show_search(overlay, false);
		show_card(kiosk, -1);
		go_home(kiosk);
		break;
	case OVERLAY_BACK:
		if (!chose_language)
			back_press(kiosk);
		break;
	case OVERLAY_HELP:
		overlay_show_help(overlay, !overlay_help(overlay));
		break;
	case OVERLAY_SEARCH:
		overlay_show_search(overlay, !overlay_searching(overlay));
		if (overlay_searching(overlay))
			counting_part(kiosk, USAGE_SEARCH, -1);
		break;
	case OVERLAY_LARGE:
	case OVERLAY_REACH:
		change_comfort(kiosk, action->kind);
		break;
	case OVERLAY_LIGHT:
		tools_press(kiosk, OVERLAY_TOOL_LIGHT);
		break;
	case OVERLAY_SECTION:
		tools_press(kiosk, OVERLAY_TOOL_SECTION);
		break;
	case OVERLAY_PICTURE:
		overlay_show_picture(overlay, action->picture);
		log_debug("app", "picture %d", action->picture);
		break;
	case OVERLAY_KEY:
		press_key(kiosk, action->key);
		break;
	case OVERLAY_FOUND:
		overlay_show_search(overlay, false);
		show_card(kiosk, action->part);
		fly_to_part(kiosk, (uint32_t)action->part);
		break;
	}
}

static void on_tap(struct kiosk *kiosk, const struct gesture *gesture)
{
	const struct overlay_action action = overlay_tap(
		information_view_overlay(kiosk->shown.view), gesture->x_px, gesture->y_px);
	int part;

	if (action.kind == OVERLAY_SWALLOWED && gesture->kind == GESTURE_DOUBLE_TAP &&
	    overlay_picture(information_view_overlay(kiosk->shown.view)) >= 0)
		overlay_picture_double_tap(information_view_overlay(kiosk->shown.view),
					   gesture->x_px, gesture->y_px);
	else if (action.kind != OVERLAY_NONE)
		carry_out(kiosk, &action);
	else if (gesture->kind == GESTURE_TAP)
		tap_model(kiosk, gesture->x_px, gesture->y_px);
	else if ((part = part_under(kiosk, gesture->x_px, gesture->y_px)) >= 0) {
		back_note(kiosk);
		open_page(kiosk, part);
	}
}

/* ---- gestures */

static void on_press(struct kiosk *kiosk, const struct gesture *gesture)
{
	struct overlay *overlay = information_view_overlay(kiosk->shown.view);

	kiosk->finger_on_words = overlay && overlay_covers(overlay, gesture->x_px, gesture->y_px);
	if (!kiosk->finger_on_words)
		grab(kiosk, gesture->x_px, gesture->y_px);
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

static void on_words(struct kiosk *kiosk, const struct gesture *gesture)
{
	struct overlay *overlay = information_view_overlay(kiosk->shown.view);

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
static void say_eye(const struct kiosk *kiosk, const char *when)
{
	const float *eye_m = kiosk->navigator.eye_m;

	log_debug("app", "%s: eye at %.3f %.3f %.3f", when, (double)eye_m[0], (double)eye_m[1],
		  (double)eye_m[2]);
}

static void on_model(struct kiosk *kiosk, const struct gesture *gesture)
{
	const float height = (float)kiosk_height_px(kiosk);
	struct overlay *overlay = information_view_overlay(kiosk->shown.view);

	switch (gesture->kind) {
	case GESTURE_DRAG_BEGIN:
	case GESTURE_PINCH_BEGIN:
		say_eye(kiosk,
			gesture->kind == GESTURE_DRAG_BEGIN ? "drag begins" : "pinch begins");
		grab(kiosk, gesture->x_px, gesture->y_px);
		if (overlay)
			overlay_show_help(overlay, false);
		break;
	case GESTURE_DRAG:
		navigator_turn(&kiosk->navigator, gesture->dx_px, gesture->dy_px, height);
		break;
	case GESTURE_DRAG_END:
		navigator_fling(&kiosk->navigator, gesture->vx_px_per_s, gesture->vy_px_per_s);
		say_eye(kiosk, "drag ends");
		break;
	case GESTURE_PINCH:
		navigator_pinch(&kiosk->navigator, gesture->scale, gesture->dx_px, gesture->dy_px,
				gesture->turn_rad, height);
		break;
	case GESTURE_PINCH_END:
		say_eye(kiosk, "pinch ends");
		break;
	default:
		break;
	}
}

static void on_gesture(void *data, const struct gesture *gesture)
{
	struct kiosk *kiosk = data;

	if (!kiosk->navigator_ready)
		return; /* nothing can be touched yet */
	kiosk_redraw(kiosk);
	if (gesture->kind == GESTURE_PRESS)
		on_press(kiosk, gesture);
	else if (gesture->kind == GESTURE_TAP || gesture->kind == GESTURE_DOUBLE_TAP) {
		if (information_view_overlay(kiosk->shown.view))
			on_tap(kiosk, gesture);
	} else if (kiosk->finger_on_words)
		on_words(kiosk, gesture);
	else
		on_model(kiosk, gesture);
}

void fingers_init(struct kiosk *kiosk)
{
	const struct gesture_options options = {
		.slop_px = SLOP_MM * kiosk->px_per_mm,
		.near_px = NEAR_MM * kiosk->px_per_mm,
		.gesture = on_gesture,
		.data = kiosk,
	};

	gesture_init(&kiosk->gestures, &options);
	kiosk->fingers_on_keys = 0;
}

/* Handles the on-screen keyboard. A key acts when the finger comes down, each finger separately:
 * two typing fingers are not a pinch, and a finger that slides off has still typed. Returns true if
 * the finger belongs to a key until it lifts. */
static bool types(struct kiosk *kiosk, const struct touch_event *event)
{
	struct overlay *overlay = information_view_overlay(kiosk->shown.view);
	const uint32_t finger = 1u << event->contact;
	struct overlay_action action;

	if (event->phase != TOUCH_DOWN) {
		const bool is_typing = kiosk->fingers_on_keys & finger;

		if (event->phase != TOUCH_MOVE)
			kiosk->fingers_on_keys &= ~finger;
		return is_typing;
	}
	if (!overlay || !kiosk->navigator_ready)
		return false;
	action = overlay_tap(overlay, event->x_px, event->y_px);
	if (action.kind != OVERLAY_KEY || action.key == OVERLAY_KEY_CLEAR)
		return false;
	kiosk->fingers_on_keys |= finger;
	press_key(kiosk, action.key);
	kiosk_redraw(kiosk);
	return true;
}

void fingers_on_touch(void *data, const struct touch_event *event)
{
	struct kiosk *kiosk = data;
	struct touch_event seen = *event;

	if (panel_takes_touch(kiosk, event) || setup_page_covers(kiosk))
		return; /* the touch only woke the panel, or the setup page is shown */
	if (visitor_takes_touch(kiosk, event))
		return;
	viewport_unshift(kiosk, &seen.x_px, &seen.y_px);
	if (!tools_take_touch(kiosk, &seen) && !types(kiosk, &seen))
		gesture_feed(&kiosk->gestures, &seen);
}

/* A wheel step acts as a pinch: on the picture if one is shown, otherwise on the model. */
static void turn_wheel(struct kiosk *kiosk, float x_px, float y_px, float scale)
{
	struct overlay *overlay = information_view_overlay(kiosk->shown.view);

	if (overlay && overlay_picture(overlay) >= 0) {
		overlay_picture_pinch(overlay, x_px, y_px, scale, 0, 0);
	} else {
		grab(kiosk, x_px, y_px);
		navigator_pinch(&kiosk->navigator, scale, 0, 0, 0, (float)kiosk_height_px(kiosk));
	}
	kiosk_redraw(kiosk);
}

void fingers_on_pointer(void *data, enum pointer_kind kind, float x_px, float y_px, float steps)
{
	static const enum touch_phase phases[] = {
		[POINTER_MOVE] = TOUCH_MOVE,
		[POINTER_DOWN] = TOUCH_DOWN,
		[POINTER_UP] = TOUCH_UP,
	};
	struct kiosk *kiosk = data;

	if (setup_page_covers(kiosk))
		return;
	viewport_from_panel(kiosk, &x_px, &y_px);
	if (kind == POINTER_WHEEL) {
		presence_touch(&kiosk->presence, clock_now_ms());
		if (kiosk->navigator_ready)
			turn_wheel(kiosk, x_px, y_px, powf(WHEEL_STEP, steps));
		return;
	}
	if (kind == POINTER_MOVE && !kiosk->gestures.fingers[0].down &&
	    kiosk->tools.held == OVERLAY_HANDLE_NONE)
		return;
	fingers_on_touch(kiosk, &(struct touch_event){
					.phase = phases[kind],
					.x_px = x_px,
					.y_px = y_px,
					.time_us = clock_now_us(),
				});
}
