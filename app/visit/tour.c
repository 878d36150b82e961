/* The state machine of one tour: how far along its path it is, and whether it waits for the eye,
 * flies, or is halted. */
#include "app/visit/tour.h"

#include <string.h>

#include "storage/info_tour.h"

enum { STEP_MOST_MS = 50 }; /* longest step of the eye: after a delay it does not jump */

_Static_assert((int)TOUR_STOPS_MAX == (int)INFO_STOPS_MAX, "stops of a tour");

void tour_way(struct tour_path *out, const struct info_tour *of, float diagonal_m)
{
	struct tour_view views[TOUR_STOPS_MAX];

	for (uint32_t i = 0; i < of->stop_count; i++) {
		const struct info_stop *stop = &of->stops[i];

		views[i].stay_s = stop->stay_s;
		views[i].travel_s = stop->travel_s;
		views[i].is_even = stop->is_even;
		memcpy(views[i].eye_m, stop->eye_m, sizeof(views[i].eye_m));
		memcpy(views[i].target_m, stop->target_m, sizeof(views[i].target_m));
	}
	tour_path_init(out, views, of->stop_count, of->attract, diagonal_m);
}

void tour_begin(struct tour *tour, uint32_t which, const struct info_tour *of, bool loops,
		float diagonal_m, int64_t now_ms)
{
	tour->state = TOUR_COMING;
	tour->which = which;
	tour->loops = loops;
	tour->at_ms = 0;
	tour->then_ms = now_ms;
	tour_way(&tour->path, of, diagonal_m);
	/* The last leg of a looping tour leads back to its start. A visitor's tour ends at the last
	 * stop, before it. */
	if (of->attract && !loops) {
		const struct tour_run *last = &tour->path.runs[tour->path.run_count - 1];

		tour->path.duration_ms = last->begin_ms;
	}
}

void tour_halt(struct tour *tour)
{
	if (tour_runs(tour))
		tour->state = TOUR_HALTED;
}

void tour_go_on(struct tour *tour)
{
	if (tour->state == TOUR_HALTED)
		tour->state = TOUR_COMING;
}

void tour_end(struct tour *tour)
{
	tour->state = TOUR_OFF;
	tour->loops = false;
}

bool tour_runs(const struct tour *tour)
{
	return tour->state == TOUR_COMING || tour->state == TOUR_FLYING;
}

/* Advances the tour. Stays pass by the clock, because nothing is drawn then; movements advance by
 * at most STEP_MOST_MS per step. */
static void advance(struct tour *tour, int64_t ms)
{
	const int64_t left_ms = tour_path_rest_ms(&tour->path, tour->at_ms);
	const int64_t stays = ms < left_ms ? ms : left_ms;

	tour->at_ms += stays;
	ms -= stays;
	tour->at_ms += ms < STEP_MOST_MS ? ms : STEP_MOST_MS;
}

bool tour_step(struct tour *tour, int64_t now_ms, bool arrived, struct tour_pose *out)
{
	const int64_t ms = now_ms - tour->then_ms;

	tour->then_ms = now_ms;
	if (tour->state == TOUR_COMING && arrived)
		tour->state = TOUR_FLYING;
	else if (tour->state == TOUR_FLYING && ms > 0)
		advance(tour, ms);
	if (tour->state != TOUR_FLYING)
		return false;
	if (tour->at_ms >= tour->path.duration_ms && tour->loops)
		tour->at_ms -= tour->path.duration_ms;
	tour_path_pose(&tour->path,
		       tour->at_ms < tour->path.duration_ms ? tour->at_ms
							    : tour->path.duration_ms - 1,
		       out);
	if (tour->at_ms >= tour->path.duration_ms)
		tour_end(tour);
	return true;
}

int tour_wait_ms(const struct tour *tour, int64_t now_ms)
{
	int64_t left_ms;

	if (tour->state != TOUR_FLYING)
		return tour->state == TOUR_COMING ? 0 : -1;
	left_ms = tour_path_rest_ms(&tour->path, tour->at_ms) - (now_ms - tour->then_ms);
	return left_ms > 0 ? (int)left_ms : 0;
}
