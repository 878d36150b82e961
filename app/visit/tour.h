/* A tour that is flown: where on its way, and whether it halts. The eye first comes to the way,
 * from wherever it is; a visitor may halt it, look around and let it go on from there; it ends by
 * itself, or, while nobody is there, goes round. Pure but for the times it is told. */
#ifndef GOPURA_APP_VISIT_TOUR_H
#define GOPURA_APP_VISIT_TOUR_H

#include "geometry/tour_path.h"
#include "storage/info.h"

enum tour_state {
	TOUR_OFF,
	TOUR_COMING, /* the eye is on its way to the way */
	TOUR_FLYING,
	TOUR_HALTED,
};

struct tour {
	enum tour_state state;
	uint32_t which; /* of the release's */
	bool loops;     /* nobody is there */
	struct tour_path path;
	int64_t at_ms, then_ms; /* on the way; of the last step */
};

/* The path as the pipeline judged it. diagonal_m: of the model's box. */
void tour_way(struct tour_path *out, const struct info_tour *of, float diagonal_m);
/* From the way's beginning, to which the eye is to come. */
void tour_begin(struct tour *tour, uint32_t which, const struct info_tour *of, bool loops,
		float diagonal_m, int64_t now_ms);
void tour_halt(struct tour *tour);
void tour_go_on(struct tour *tour); /* the eye is to come to where it was */
void tour_end(struct tour *tour);
/* It moves the eye, or waits for it to come. */
bool tour_runs(const struct tour *tour);

/* Lets time pass. arrived: the eye's flight to the way is over. true: out is where it is now; it
 * may have ended there. */
bool tour_step(struct tour *tour, int64_t now_ms, bool arrived, struct tour_pose *out);
/* Until something moves, milliseconds; 0: it does; -1: nothing will by itself. */
int tour_wait_ms(const struct tour *tour, int64_t now_ms);

#endif
