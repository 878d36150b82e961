/* Plays guided tours in the kiosk: starts and halts them, flies the eye to their path, and shows
 * captions in the overlay. */
#include <math.h>
#include <string.h>

#include <cglm/cglm.h>

#include "app/kiosk.h"
#include "base/clock.h"
#include "base/log.h"

#define CALM_SHARE 0.1f /* of the model's diagonal per second: speed of the flight to the path */

enum { COME_LEAST_MS = 1200, COME_MOST_MS = 5000 };

/* Returns the current tour, or NULL. */
static const struct info_tour *flown(const struct kiosk *kiosk)
{
	const struct info *info = information_view_info(kiosk->shown.view);

	if (kiosk->tour.state == TOUR_OFF || !info || kiosk->tour.which >= info_tour_count(info))
		return NULL;
	return info_tour(info, kiosk->tour.which);
}

/* Logs the eye where a tour is halted or continues. */
static void say_eye(const struct kiosk *kiosk, const char *what)
{
	const float *eye_m = kiosk->navigator.eye_m;

	log_debug("app", "tour %s: eye at %.3f %.3f %.3f", what, (double)eye_m[0], (double)eye_m[1],
		  (double)eye_m[2]);
}

static void come(struct kiosk *kiosk)
{
	struct navigator *nav = &kiosk->navigator;
	struct tour_pose pose;
	float ms;

	tour_path_pose(&kiosk->tour.path, kiosk->tour.at_ms, &pose);
	ms = 1000 * glm_vec3_distance(nav->eye_m, pose.eye_m) /
	     (CALM_SHARE * navigator_diagonal_m(nav));
	navigator_fly(nav, pose.eye_m, pose.target_m, glm_clamp(ms, COME_LEAST_MS, COME_MOST_MS));
	kiosk_redraw(kiosk);
}

static void begin(struct kiosk *kiosk, uint32_t which, bool loops)
{
	const struct info_tour *tour = info_tour(information_view_info(kiosk->shown.view), which);

	tour_begin(&kiosk->tour, which, tour, loops, navigator_diagonal_m(&kiosk->navigator),
		   clock_now_ms());
	log_debug("app", "tour %s%s", tour->id, loops ? " for nobody" : "");
	come(kiosk);
}

bool tour_player_go_round(struct kiosk *kiosk)
{
	const struct info *info = information_view_info(kiosk->shown.view);

	for (uint32_t i = 0; info && i < info_tour_count(info); i++)
		if (info_tour(info, i)->attract) {
			begin(kiosk, i, true);
			return true;
		}
	return false;
}

/* Closes everything that covers the model, so that the tour can be seen. */
static void clear(struct overlay *overlay)
{
	overlay_close_page(overlay);
	overlay_show_search(overlay, false);
	overlay_show_tours(overlay, false);
	overlay_show_help(overlay, false);
	overlay_show_card(overlay, -1);
}

void tour_player_start(struct kiosk *kiosk, int which)
{
	const struct info *info = information_view_info(kiosk->shown.view);

	if (!info || which < 0 || (uint32_t)which >= info_tour_count(info))
		return;
	clear(information_view_overlay(kiosk->shown.view));
	begin(kiosk, (uint32_t)which, false);
	counting_id(kiosk, USAGE_TOUR, info_tour(info, (uint32_t)which)->id);
}

void tour_player_halt(struct kiosk *kiosk)
{
	if (kiosk->tour.loops)
		tour_end(&kiosk->tour); /* it ran for nobody, and now somebody came */
	if (!tour_runs(&kiosk->tour))
		return;
	tour_halt(&kiosk->tour);
	say_eye(kiosk, "halts");
}

void tour_player_go_on(struct kiosk *kiosk)
{
	if (kiosk->tour.state != TOUR_HALTED)
		return;
	clear(information_view_overlay(kiosk->shown.view));
	tour_go_on(&kiosk->tour);
	log_debug("app", "tour goes on");
	come(kiosk);
}

void tour_player_end(struct kiosk *kiosk)
{
	if (kiosk->tour.state != TOUR_OFF)
		log_debug("app", "tour ends");
	tour_end(&kiosk->tour);
}

void tour_player_press(struct kiosk *kiosk)
{
	struct overlay *overlay = information_view_overlay(kiosk->shown.view);
	const struct info *info = information_view_info(kiosk->shown.view);

	if (kiosk->tour.state == TOUR_HALTED)
		tour_player_go_on(kiosk);
	else if (tour_runs(&kiosk->tour))
		tour_player_halt(kiosk);
	else if (info_tour_count(info) == 1)
		tour_player_start(kiosk, 0);
	else
		overlay_show_tours(overlay, !overlay_choosing(overlay));
}

bool tour_player_leads_eye(struct kiosk *kiosk, int64_t now_ms)
{
	const enum tour_state before = kiosk->tour.state;
	struct tour_pose pose;

	/* The release has changed, or somebody came. */
	if (!flown(kiosk) || (kiosk->tour.loops && kiosk->presence.state != PRESENCE_NOBODY))
		tour_end(&kiosk->tour);
	if (!tour_step(&kiosk->tour, now_ms, kiosk->navigator.flight_left_ms <= 0, &pose))
		return false;
	navigator_look(&kiosk->navigator, pose.eye_m, pose.target_m);
	if (before == TOUR_COMING)
		say_eye(kiosk, "flies");
	if (kiosk->tour.state == TOUR_OFF)
		log_debug("app", "tour ends");
	return pose.moves;
}

/* ---- what the overlay shows */

/* Returns the stop whose caption is shown: the current or next stop at which the tour stays. Stops
 * that are only passed have none. */
static uint32_t spoken_stop(const struct kiosk *kiosk, const struct info_tour *tour)
{
	struct tour_pose pose;
	uint32_t stop;

	tour_path_pose(&kiosk->tour.path, kiosk->tour.at_ms, &pose);
	stop = pose.stop;
	while (tour->stops[stop].stay_s == 0)
		stop = (stop + 1) % tour->stop_count; /* a tour always stays at its last stop */
	return stop;
}

int tour_player_part(const struct kiosk *kiosk)
{
	const struct info_tour *tour = flown(kiosk);
	struct tour_pose pose;

	if (!tour || kiosk->tour.state == TOUR_COMING)
		return -1;
	tour_path_pose(&kiosk->tour.path, kiosk->tour.at_ms, &pose);
	return pose.moves ? -1 : tour->stops[pose.stop].part;
}

void tour_player_say(struct kiosk *kiosk)
{
	struct overlay *overlay = information_view_overlay(kiosk->shown.view);
	const struct info *info = information_view_info(kiosk->shown.view);
	const struct info_tour *tour = flown(kiosk);
	struct overlay_tour_state state = { .paused = kiosk->tour.state == TOUR_HALTED };
	const char *language;
	uint32_t stop;

	if (!overlay || !info)
		return;
	if (!tour || kiosk->tour.loops) {
		overlay_show_tour(overlay, NULL);
		return;
	}
	language = information_view_language(kiosk->shown.view);
	stop = spoken_stop(kiosk, tour);
	state.tour = (int)kiosk->tour.which;
	state.caption = info_stop_caption(info, kiosk->tour.which, stop, language);
	if (!*state.caption && tour->stops[stop].part >= 0)
		state.caption = info_text(info, (uint32_t)tour->stops[stop].part, language).caption;
	for (uint32_t i = 0; i < tour->stop_count; i++) {
		state.stop_count += tour->stops[i].stay_s > 0;
		state.stop += tour->stops[i].stay_s > 0 && i < stop;
	}
	overlay_show_tour(overlay, &state);
}
