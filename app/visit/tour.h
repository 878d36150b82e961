/* One running tour: its position on the path, and whether it is halted. The eye first flies to the
 * path from where it is. A visitor may halt the tour, look around, and continue from the same
 * position. It ends by itself or, while nobody is there, loops. Pure: all times are passed in. */
#ifndef GOPURA_APP_VISIT_TOUR_H
#define GOPURA_APP_VISIT_TOUR_H

#include "geometry/tour_path.h"
#include "storage/info.h"
#include "storage/info_tour.h"

enum tour_state {
	TOUR_OFF,
	TOUR_COMING, /* the eye is flying to the path */
	TOUR_FLYING,
	TOUR_HALTED,
};

struct tour {
	enum tour_state state;
	uint32_t which; /* index of the tour in the release */
	bool loops;     /* runs while nobody is there */
	struct tour_path path;
	int64_t at_ms, then_ms; /* position on the path; time of the last step */
};

/* Computes the path of a tour, in the same way as the pipeline that checked it. diagonal_m: of the
 * model's bounding box. */
void tour_way(struct tour_path *out, const struct info_tour *of, float diagonal_m);
/* Starts a tour at the beginning of its path; the caller then flies the eye there. which: its
 * index, of: the tour itself, borrowed for the call. loops: for the time while nobody is there. */
void tour_begin(struct tour *tour, uint32_t which, const struct info_tour *of, bool loops,
		float diagonal_m, int64_t now_ms);
/* Halts the tour, if it runs. */
void tour_halt(struct tour *tour);
void tour_go_on(struct tour *tour); /* continues a halted tour; the caller flies the eye back to its
				       position */
/* Ends the tour; one that is off is fine. */
void tour_end(struct tour *tour);
/* Returns whether it moves the eye, or waits until the eye has reached the path. */
bool tour_runs(const struct tour *tour);

/* Advances the tour to now_ms. arrived: the eye's flight to the path is over. Returns true if *out
 * is the pose for the eye; the tour may have ended with it. */
bool tour_step(struct tour *tour, int64_t now_ms, bool arrived, struct tour_pose *out);
/* Returns the milliseconds until the eye moves; 0: it is moving; -1: it will not move by itself. */
int tour_wait_ms(const struct tour *tour, int64_t now_ms);

#endif
