/* Plays the tours of the release that is shown. The eye's flight to the path is the navigator's; on
 * the path the tour leads it. */
#include "app/visit/tour_player.h"

#include <math.h>

#include "base/clock.h"
#include "base/log.h"
#include "geometry/vec.h"
#include "storage/info_tour.h"

#define CALM_SHARE 0.1f /* of the model's diagonal per second: speed of the flight to the path */

enum { COME_LEAST_MS = 1200, COME_MOST_MS = 5000 };

void tour_player_init(struct tour_player *player, const struct tour_player_env *env)
{
	*player = (struct tour_player){ .env = *env };
}

/* Returns the current tour, or NULL. */
static const struct info_tour *flown(const struct tour_player *player)
{
	const struct info *info = exhibit_info(player->env.shown);

	if (player->tour.state == TOUR_OFF || !info || player->tour.which >= info_tour_count(info))
		return NULL;
	return info_tour(info, player->tour.which);
}

static void come(struct tour_player *player)
{
	struct navigator *nav = &player->env.eye->navigator;
	struct tour_pose pose;
	float ms;

	tour_path_pose(&player->tour.path, player->tour.at_ms, &pose);
	ms = 1000 * vec_distance(nav->eye_m, pose.eye_m) / (CALM_SHARE * navigator_diagonal_m(nav));
	navigator_fly(nav, pose.eye_m, pose.target_m,
		      fminf(fmaxf(ms, COME_LEAST_MS), COME_MOST_MS));
	redraw_ask(player->env.redraw);
}

static void begin(struct tour_player *player, uint32_t which, bool loops)
{
	const struct info_tour *tour = info_tour(exhibit_info(player->env.shown), which);

	tour_begin(&player->tour, which, tour, loops,
		   navigator_diagonal_m(&player->env.eye->navigator), clock_now_ms());
	log_debug("app", "tour %s%s", tour->id, loops ? " for nobody" : "");
	come(player);
}

bool tour_player_start_loop(struct tour_player *player)
{
	const struct info *info = exhibit_info(player->env.shown);

	for (uint32_t i = 0; info && i < info_tour_count(info); i++)
		if (info_tour(info, i)->attract) {
			begin(player, i, true);
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

void tour_player_start(struct tour_player *player, int which)
{
	const struct info *info = exhibit_info(player->env.shown);

	if (!info || which < 0 || (uint32_t)which >= info_tour_count(info))
		return;
	clear(exhibit_overlay(player->env.shown));
	begin(player, (uint32_t)which, false);
	counting_id(player->env.counting, USAGE_TOUR, info_tour(info, (uint32_t)which)->id);
}

void tour_player_halt(struct tour_player *player)
{
	if (player->tour.loops)
		tour_end(&player->tour); /* it ran for nobody, and now somebody came */
	if (!tour_runs(&player->tour))
		return;
	tour_halt(&player->tour);
	eye_log(player->env.eye, "tour halts");
}

/* Continues a halted tour from where it was. */
static void go_on(struct tour_player *player)
{
	clear(exhibit_overlay(player->env.shown));
	tour_go_on(&player->tour);
	log_debug("app", "tour goes on");
	come(player);
}

void tour_player_end(struct tour_player *player)
{
	if (player->tour.state != TOUR_OFF)
		log_debug("app", "tour ends");
	tour_end(&player->tour);
}

void tour_player_on_release(void *data, const struct exhibit_change *change)
{
	(void)change;
	tour_player_end(data);
}

bool tour_player_has_visitor(const struct tour_player *player)
{
	return player->tour.state != TOUR_OFF && !player->tour.loops;
}

void tour_player_press(struct tour_player *player)
{
	struct overlay *overlay = exhibit_overlay(player->env.shown);
	const struct info *info = exhibit_info(player->env.shown);

	if (player->tour.state == TOUR_HALTED)
		go_on(player);
	else if (tour_runs(&player->tour))
		tour_player_halt(player);
	else if (info_tour_count(info) == 1)
		tour_player_start(player, 0);
	else
		overlay_show_tours(overlay, !overlay_choosing(overlay));
}

bool tour_player_lead_eye(struct tour_player *player, int64_t now_ms, bool nobody)
{
	const enum tour_state before = player->tour.state;
	struct tour_pose pose;

	/* The release has changed, or somebody came. */
	if (!flown(player) || (player->tour.loops && !nobody))
		tour_end(&player->tour);
	if (!tour_step(&player->tour, now_ms, player->env.eye->navigator.flight_left_ms <= 0,
		       &pose))
		return false;
	navigator_look(&player->env.eye->navigator, pose.eye_m, pose.target_m);
	if (before == TOUR_COMING)
		eye_log(player->env.eye, "tour flies");
	if (player->tour.state == TOUR_OFF)
		log_debug("app", "tour ends");
	return pose.moves;
}

/* ---- what the overlay shows */

/* Returns the stop whose caption is shown: the current or next stop at which the tour stays. Stops
 * that are only passed have none. */
static uint32_t spoken_stop(const struct tour_player *player, const struct info_tour *tour)
{
	struct tour_pose pose;
	uint32_t stop;

	tour_path_pose(&player->tour.path, player->tour.at_ms, &pose);
	stop = pose.stop;
	while (tour->stops[stop].stay_s == 0)
		stop = (stop + 1) % tour->stop_count; /* a tour always stays at its last stop */
	return stop;
}

int tour_player_part(const struct tour_player *player)
{
	const struct info_tour *tour = flown(player);
	struct tour_pose pose;

	if (!tour || player->tour.state == TOUR_COMING)
		return -1;
	tour_path_pose(&player->tour.path, player->tour.at_ms, &pose);
	return pose.moves ? -1 : tour->stops[pose.stop].part;
}

void tour_player_show(struct tour_player *player)
{
	struct overlay *overlay = exhibit_overlay(player->env.shown);
	const struct info *info = exhibit_info(player->env.shown);
	const struct info_tour *tour = flown(player);
	struct overlay_tour_state state = { .paused = player->tour.state == TOUR_HALTED };
	const char *language;
	uint32_t stop;

	if (!overlay || !info)
		return;
	if (!tour || player->tour.loops) {
		overlay_show_tour(overlay, NULL);
		return;
	}
	language = information_view_language(player->env.shown->view);
	stop = spoken_stop(player, tour);
	state.tour = (int)player->tour.which;
	state.caption = info_stop_caption(info, player->tour.which, stop, language);
	if (!*state.caption && tour->stops[stop].part >= 0)
		state.caption = info_text(info, (uint32_t)tour->stops[stop].part, language).caption;
	for (uint32_t i = 0; i < tour->stop_count; i++) {
		state.stop_count += tour->stops[i].stay_s > 0;
		state.stop += tour->stops[i].stay_s > 0 && i < stop;
	}
	overlay_show_tour(overlay, &state);
}
