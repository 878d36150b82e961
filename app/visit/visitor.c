/* Follows the state of presence: leads the eye while nobody is there, keeps the overlay's
 * invitation and question up to date, and resets everything between two visitors. */
#include "app/visit/visitor.h"

#include "base/clock.h"
#include "base/log.h"

enum { HOMEWARD_MS = 2500 };

void visitor_init(struct visitor *visitor, const struct visitor_options *options,
		  const struct visitor_env *env)
{
	*visitor = (struct visitor){ .options = *options, .env = *env, .asked_s = -1 };
	presence_init(&visitor->presence, options->idle_s, clock_now_ms());
	visitor->logged = visitor->presence.state;
}

static bool is_off(const struct visitor *visitor)
{
	return visitor->options.off || !visitor->env.eye->ready;
}

static bool nobody_is_there(const struct visitor *visitor)
{
	return visitor->presence.state == PRESENCE_NOBODY;
}

/* Returns whether the visitor is busy with something that needs few touches. */
static bool is_reading(const struct visitor *visitor)
{
	const struct overlay *overlay = exhibit_overlay(visitor->env.shown);

	if ((visitor->down & ~visitor->answers) != 0)
		return true;
	return overlay && (overlay_card(overlay) >= 0 || overlay_page(overlay) >= 0 ||
			   overlay_searching(overlay) || overlay_choosing(overlay) ||
			   overlay_choosing_language(overlay) ||
			   visitor->env.tours->tour.state == TOUR_HALTED ||
			   tools_are_used(visitor->env.tools));
}

/* Returns whether the visitor watches a tour or hears a text: both end by themselves. */
static bool is_led(const struct visitor *visitor)
{
	const struct tour *tour = &visitor->env.tours->tour;

	return (tour_runs(tour) && !tour->loops) || visitor->env.listening->speaks;
}

/* ---- between two visitors */

static void reset_overlay(const struct visitor *visitor, struct overlay *overlay)
{
	const struct exhibit *shown = visitor->env.shown;
	const char *language = visitor->options.language;

	overlay_close_page(overlay);
	overlay_show_card(overlay, -1);
	overlay_show_search(overlay, false);
	overlay_show_tours(overlay, false);
	overlay_show_languages(overlay, false);
	if (overlay_comfort(overlay).large || overlay_comfort(overlay).reach)
		log_debug("app", "comfort: forgotten");
	overlay_set_comfort(overlay, (struct overlay_comfort){ 0 });
	information_view_set_language(shown->view,
				      language ? language : info_language(exhibit_info(shown), 0));
}

/* Resets everything, so that nothing of one visitor is left for the next. */
static void end_visit(struct visitor *visitor)
{
	const struct visitor_env *env = &visitor->env;
	struct overlay *overlay = exhibit_overlay(env->shown);

	tour_player_end(env->tours);
	tools_end(env->tools);
	back_forget(env->back);
	if (env->shown->scene)
		scene_reset_scenery(env->shown->scene);
	if (overlay)
		reset_overlay(visitor, overlay);
	visitor->down = 0;
	visitor->circles = false;
	env->ended(env->data);
	counting_write(env->counting);
}

/* Flies the eye to the start of the attract camera. */
static void start_circling(struct visitor *visitor, int64_t now_ms)
{
	struct navigator *navigator = &visitor->env.eye->navigator;
	const struct navigator_options *o = &navigator->options;
	float eye_m[3], target_m[3];

	attract_camera_init(&visitor->attract, o->box_min_m, o->box_max_m, o->home_eye_m,
			    o->home_target_m);
	attract_camera_pose(&visitor->attract, 0, eye_m, target_m);
	navigator_fly(navigator, eye_m, target_m, HOMEWARD_MS);
	visitor->attract_since_ms = now_ms;
	visitor->circles = true;
}

/* Presents the model while nobody is there, by a tour or the attract camera. The release may have
 * changed, and its database may arrive late. */
static void present(struct visitor *visitor, int64_t now_ms)
{
	if (visitor->env.tours->tour.state == TOUR_OFF &&
	    !tour_player_start_loop(visitor->env.tours) && !visitor->circles)
		start_circling(visitor, now_ms);
}

/* ---- the loop */

static void log_state(struct visitor *visitor)
{
	static const char *const states[] = {
		[PRESENCE_NOBODY] = "nobody is there",
		[PRESENCE_SOMEBODY] = "somebody is there",
		[PRESENCE_ASKED] = "is somebody there?",
	};

	if (visitor->logged != visitor->presence.state)
		log_debug("app", "%s", states[visitor->presence.state]);
	visitor->logged = visitor->presence.state;
}

/* Returns the milliseconds until the eye moves by itself; -1: it does not. */
static int eye_wait_ms(const struct visitor *visitor, int64_t now_ms)
{
	const struct tour *tour = &visitor->env.tours->tour;

	if (tour->state != TOUR_OFF)
		return tour_wait_ms(tour, now_ms);
	return nobody_is_there(visitor) ? attract_camera_rest_ms(now_ms - visitor->attract_since_ms)
					: -1;
}

/* The overlay may be new, so it is told each time. */
static void tell_overlay(const struct visitor *visitor, int asked_s)
{
	struct overlay *overlay = exhibit_overlay(visitor->env.shown);

	if (!overlay)
		return;
	overlay_invite(overlay, nobody_is_there(visitor));
	overlay_ask(overlay, asked_s);
	tour_player_show(visitor->env.tours);
}

void visitor_turn(struct visitor *visitor, bool is_dark)
{
	const int64_t now_ms = clock_now_ms();
	const enum presence_state before = visitor->presence.state;
	int asked_s;

	if (is_off(visitor))
		return;
	if (is_led(visitor) && !is_dark)
		presence_keep(&visitor->presence, now_ms);
	presence_step(&visitor->presence, now_ms, is_reading(visitor));
	log_state(visitor);
	if (nobody_is_there(visitor) && before != PRESENCE_NOBODY)
		end_visit(visitor);
	if (nobody_is_there(visitor))
		present(visitor, now_ms);
	asked_s = presence_asked_s(&visitor->presence, now_ms);
	tell_overlay(visitor, asked_s);
	if (visitor->presence.state != before || asked_s != visitor->asked_s ||
	    eye_wait_ms(visitor, now_ms) == 0)
		redraw_ask(visitor->env.redraw);
	visitor->asked_s = asked_s;
}

int visitor_wait_ms(const struct visitor *visitor)
{
	const int64_t now_ms = clock_now_ms();
	int eye_ms, presence_ms;

	if (is_off(visitor))
		return -1;
	eye_ms = eye_wait_ms(visitor, now_ms);
	presence_ms = presence_wait_ms(&visitor->presence, now_ms);
	return clock_sooner_ms(eye_ms, presence_ms);
}

bool visitor_lead_eye(struct visitor *visitor, int64_t now_ms)
{
	struct navigator *navigator = &visitor->env.eye->navigator;
	float eye_m[3], target_m[3];
	bool moves;

	if (is_off(visitor))
		return false;
	if (visitor->env.tours->tour.state != TOUR_OFF)
		return tour_player_lead_eye(visitor->env.tours, now_ms, nobody_is_there(visitor));
	if (!nobody_is_there(visitor))
		return false;
	if (navigator->flight_left_ms > 0) {
		/* On its way to the circle, which may lead around walls. */
		visitor->attract_since_ms = now_ms;
		return false;
	}
	moves = attract_camera_pose(&visitor->attract, now_ms - visitor->attract_since_ms, eye_m,
				    target_m);
	navigator_look(navigator, eye_m, target_m);
	return moves;
}

/* ---- touches */

void visitor_stay(struct visitor *visitor)
{
	presence_touch(&visitor->presence, clock_now_ms());
}

bool visitor_take_touch(struct visitor *visitor, const struct touch_event *event)
{
	const uint32_t bit = 1u << event->contact;
	const bool asked = visitor->presence.state == PRESENCE_ASKED;

	if (!visitor->presence.touched)
		counting_part(visitor->env.counting, USAGE_VISIT, -1);
	visitor_stay(visitor);
	if (event->phase == TOUCH_DOWN) {
		visitor->down |= bit;
		visitor->answers = asked ? visitor->answers | bit : visitor->answers & ~bit;
	} else if (event->phase != TOUCH_MOVE) {
		visitor->down &= ~bit;
	}
	if (asked)
		redraw_ask(visitor->env.redraw);
	return (visitor->answers & bit) != 0;
}

void visitor_on_release(void *data, const struct exhibit_change *change)
{
	const char *language = information_view_language(change->before->view);
	struct overlay *overlay = exhibit_overlay(change->shown);
	struct visitor *visitor = data;

	visitor->circles = false;
	if (language)
		information_view_set_language(change->shown->view, language);
	if (overlay) /* NULL if the panel is too small for it */
		overlay_show_help(overlay, false);
}

int visitor_left_ms(const struct visitor *visitor)
{
	if (!visitor->presence.touched || visitor->env.shown->frame.patches == 0)
		return 0;
	return presence_left_ms(&visitor->presence, clock_now_ms());
}
