/* The way of a guided tour: where the eye is, and where it looks, at any time of it. The pipeline
 * judges this curve against the scan, and the kiosk flies it: docs/tours.md.
 *
 * A pose is a point of five numbers, place and direction, the latter in metres that an angle is
 * worth. The way is the centripetal Catmull-Rom curve through the stops' poses, which has neither
 * cusps nor loops between two of them, and at every stop goes the way of its neighbours. Between
 * two stops that stay it is passed at one go, by its length: slowly out of the one and slowly into
 * the other, without a halt at those that are only on the way. Pure; a value. */
#ifndef GOPURA_GEOMETRY_TOUR_PATH_H
#define GOPURA_GEOMETRY_TOUR_PATH_H

#include <stdbool.h>
#include <stdint.h>

enum {
	TOUR_STOPS_MAX = 64,
	TOUR_AXES = 5,
	TOUR_PIECES = 64 /* of a leg, by which it is measured */
};

struct tour_view {
	float eye_m[3], target_m[3];
	float stay_s;   /* 0: only on the way; the first and the last stay */
	float travel_s; /* of the leg to it; 0: by its length */
};

/* From a stop to the next one. */
struct tour_leg {
	float poses[4][TOUR_AXES]; /* before, from, to, after */
	float knots[4];
	float to_m[TOUR_PIECES + 1]; /* length of the way up to each piece's end */
};

/* Legs without a halt between. */
struct tour_run {
	uint32_t first_leg, leg_count;
	float length_m;
	int64_t begin_ms, move_ms;
};

struct tour_path {
	uint32_t stop_count, leg_count, run_count;
	float metres_a_radian;
	struct tour_leg legs[TOUR_STOPS_MAX];
	struct tour_run runs[TOUR_STOPS_MAX];
	int64_t duration_ms; /* of all; of a closed one until it begins anew */
};

/* A tour's count of stops is 2 to TOUR_STOPS_MAX. closed: a last leg leads back to the first stop.
 * diagonal_m: of the model's box, to which speed is in proportion. */
void tour_path_init(struct tour_path *path, const struct tour_view *stops, uint32_t count,
		    bool closed, float diagonal_m);

struct tour_pose {
	float eye_m[3], target_m[3]; /* a metre apart */
	uint32_t stop;               /* where it stays, or goes next */
	bool moves;
};

/* So long after it began; before and after its ends it is there. */
void tour_path_pose(const struct tour_path *path, int64_t ms, struct tour_pose *out);
/* The leg's place at a share of its length, 0 to 1. */
void tour_path_place(const struct tour_path *path, uint32_t leg, float share, float eye_m[3]);
float tour_path_leg_m(const struct tour_path *path, uint32_t leg);
/* Until it moves on; 0: it moves, or has ended. */
int64_t tour_path_rest_ms(const struct tour_path *path, int64_t ms);

/* What is nearer to the way than this is in it: no near plane, however wide the panel, reaches it.
 * diagonal_m as above. */
float tour_path_clearance_m(float diagonal_m);

#endif
