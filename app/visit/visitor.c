/* Manages a visit: while nobody is there, the model presents itself; after a time without a touch
 * the visitor is asked; after a visit everything is reset for the next visitor. */
#include "app/kiosk.h"
#include "base/clock.h"
#include "base/log.h"

enum { HOMEWARD_MS = 2500 };

static bool is_reading(const struct kiosk *kiosk)
{
	const struct overlay *overlay = information_view_overlay(kiosk->shown.view);

	for (size_t i = 0; i < TOUCH_CONTACTS_MAX; i++)
		if (kiosk->gestures.fingers[i].down)
			return true;
	return overlay && (overlay_card(overlay) >= 0 || overlay_page(overlay) >= 0 ||
			   overlay_searching(overlay) || overlay_choosing(overlay) ||
			   overlay_choosing_language(overlay) || kiosk->tour.state == TOUR_HALTED ||
			   kiosk->tools.now.rake.on || kiosk->tools.now.section.on);
}

/* Resets everything, so that nothing of one visitor is left for the next. */
static void begin_anew(struct kiosk *kiosk)
{
	struct overlay *overlay = information_view_overlay(kiosk->shown.view);
	const char *language = kiosk->options.language;

	tour_player_end(kiosk);
	tools_end(kiosk);
	back_forget(kiosk);
	if (overlay) {
		overlay_close_page(overlay);
		overlay_show_card(overlay, -1);
		overlay_show_search(overlay, false);
		overlay_show_tours(overlay, false);
		overlay_show_languages(overlay, false);
		if (overlay_comfort(overlay).large || overlay_comfort(overlay).reach)
			log_debug("app", "comfort: forgotten");
		overlay_set_comfort(overlay, (struct overlay_comfort){ 0 });
		information_view_set_language(
			kiosk->shown.view,
			language ? language
				 : info_language(information_view_info(kiosk->shown.view), 0));
	}
	gesture_reset(&kiosk->gestures); /* fingers still on the glass belong to nobody */
	kiosk->fingers_on_keys = 0;
	if (kiosk->usage)
		usage_write(kiosk->usage);
}

/* Starts the tour for the time while nobody is there, or flies the eye to the start of the attract
 * camera. */
static void send_round(struct kiosk *kiosk, int64_t now_ms)
{
	const struct navigator_options *o = &kiosk->navigator.options;
	float eye_m[3], target_m[3];

	if (tour_player_go_round(kiosk))
		return;
	attract_camera_init(&kiosk->attract, o->box_min_m, o->box_max_m, o->home_eye_m,
			    o->home_target_m);
	attract_camera_pose(&kiosk->attract, 0, eye_m, target_m);
	navigator_fly(&kiosk->navigator, eye_m, target_m, HOMEWARD_MS);
	kiosk->attract_camera_since_ms = now_ms + HOMEWARD_MS;
}

/* Logs a change of the visitor's state. */
static void say_state(struct kiosk *kiosk)
{
	static const char *const states[] = {
		[PRESENCE_NOBODY] = "nobody is there",
		[PRESENCE_SOMEBODY] = "somebody is there",
		[PRESENCE_ASKED] = "is somebody there?",
	};

	if (kiosk->presence_said != kiosk->presence.state)
		log_debug("app", "%s", states[kiosk->presence.state]);
	kiosk->presence_said = kiosk->presence.state;
}

static bool is_off(const struct kiosk *kiosk)
{
	return kiosk->options.views_path || !kiosk->navigator_ready;
}

/* Returns the milliseconds until the eye moves by itself; -1: it does not. */
static int eye_wait_ms(const struct kiosk *kiosk, int64_t now_ms)
{
	if (kiosk->tour.state != TOUR_OFF)
		return tour_wait_ms(&kiosk->tour, now_ms);
	return kiosk->presence.state == PRESENCE_NOBODY
		       ? attract_camera_rest_ms(now_ms - kiosk->attract_camera_since_ms)
		       : -1;
}

void visitor_watch(struct kiosk *kiosk)
{
	const int64_t now_ms = clock_now_ms();
	const enum presence_state before = kiosk->presence.state;
	struct overlay *overlay = information_view_overlay(kiosk->shown.view);
	int asked_s;

	if (is_off(kiosk))
		return;
	if (!kiosk->tour.loops && tour_runs(&kiosk->tour))
		presence_keep(&kiosk->presence, now_ms);
	presence_step(&kiosk->presence, now_ms, is_reading(kiosk));
	say_state(kiosk);
	if (kiosk->presence.state == PRESENCE_NOBODY && before != PRESENCE_NOBODY) {
		begin_anew(kiosk);
		send_round(kiosk, now_ms);
	} else if (kiosk->presence.state == PRESENCE_NOBODY && kiosk->tour.state == TOUR_OFF) {
		tour_player_go_round(kiosk); /* its database may have arrived late */
	}
	asked_s = presence_asked_s(&kiosk->presence, now_ms);
	if (overlay) { /* the overlay may be new, so tell it each time */
		overlay_invite(overlay, kiosk->presence.state == PRESENCE_NOBODY);
		overlay_ask(overlay, asked_s);
		tour_player_say(kiosk);
	}
	if (kiosk->presence.state != before || asked_s != kiosk->asked_s)
		kiosk_redraw(kiosk);
	kiosk->asked_s = asked_s;
	if (eye_wait_ms(kiosk, now_ms) == 0)
		kiosk_redraw(kiosk);
}

int visitor_wait_ms(const struct kiosk *kiosk)
{
	const int64_t now_ms = clock_now_ms();

	if (is_off(kiosk))
		return -1;
	return sooner(eye_wait_ms(kiosk, now_ms), presence_wait_ms(&kiosk->presence, now_ms));
}

bool visitor_leads_eye(struct kiosk *kiosk, int64_t now_ms)
{
	float eye_m[3], target_m[3];
	bool moves;

	if (is_off(kiosk))
		return false;
	if (kiosk->tour.state != TOUR_OFF)
		return tour_player_leads_eye(kiosk, now_ms);
	if (kiosk->presence.state != PRESENCE_NOBODY || now_ms < kiosk->attract_camera_since_ms)
		return false;
	moves = attract_camera_pose(&kiosk->attract, now_ms - kiosk->attract_camera_since_ms, eye_m,
				    target_m);
	navigator_look(&kiosk->navigator, eye_m, target_m);
	return moves;
}

bool visitor_takes_touch(struct kiosk *kiosk, const struct touch_event *event)
{
	const uint32_t bit = 1u << event->contact;
	const bool asked = kiosk->presence.state == PRESENCE_ASKED;

	if (!kiosk->presence.touched)
		counting_part(kiosk, USAGE_VISIT, -1);
	presence_touch(&kiosk->presence, clock_now_ms());
	if (event->phase == TOUCH_DOWN)
		kiosk->answers = asked ? kiosk->answers | bit : kiosk->answers & ~bit;
	if (asked)
		kiosk_redraw(kiosk);
	return (kiosk->answers & bit) != 0;
}

int visitor_left_ms(const struct kiosk *kiosk)
{
	if (!kiosk->presence.touched || kiosk->shown.frame.patches == 0)
		return 0;
	return presence_left_ms(&kiosk->presence, clock_now_ms());
}
