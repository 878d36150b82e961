/* The camera path of a guided tour: where the eye is and where it looks at any time. The pipeline
 * checks this curve against the scan, and the kiosk flies it: docs/tours.md.
 *
 * A pose is a point in five dimensions: the position, and yaw and pitch converted to metres
 * (metres_a_radian). The path is the centripetal Catmull-Rom curve through the poses of the stops,
 * which has no cusps or loops between two of them; its tangent at a stop follows from the
 * neighbouring stops. The part between two stops where the camera stays is flown in one go,
 * parametrised by its length. It starts and ends slowly, and does not halt at stops that are only
 * passed.
 *
 * A leg that is even is flown as interpolators of scenes move a camera (VRML97 6.36): on a straight
 * line between the two poses, at one speed, in exactly its time. Pure functions on a plain value.
 */
#ifndef GOPURA_GEOMETRY_TOUR_PATH_H
#define GOPURA_GEOMETRY_TOUR_PATH_H

#include <stdbool.h>
#include <stdint.h>

enum {
	TOUR_STOPS_MAX = 64,
	TOUR_AXES = 5,
	TOUR_PIECES = 64 /* pieces into which a leg is divided to measure its length */
};

struct tour_view {
	float eye_m[3], target_m[3];
	/* seconds at the stop; 0: passed without a halt. The first and the last stop stay */
	float stay_s;
	float travel_s; /* seconds of the leg to it; 0: follows from its length */
	bool is_even;   /* the leg to it is; travel_s is above 0 */
};

/* The curve from one stop to the next. */
struct tour_leg {
	float poses[4][TOUR_AXES]; /* of the stops before, from, to and after */
	float knots[4];
	float to_m[TOUR_PIECES + 1]; /* length of the curve up to the end of each piece */
};

/* Consecutive legs without a halt between them, or one that is even. */
struct tour_run {
	uint32_t first_leg, leg_count;
	bool is_even;
	float length_m;
	int64_t begin_ms, move_ms;
};

struct tour_path {
	uint32_t stop_count, leg_count, run_count;
	float metres_a_radian;
	struct tour_leg legs[TOUR_STOPS_MAX];
	struct tour_run runs[TOUR_STOPS_MAX];
	int64_t duration_ms; /* of the whole tour; of a closed tour: until it starts again */
};

/* Computes the path. count is 2 to TOUR_STOPS_MAX; stops are read only during the call. closed: a
 * last leg leads back to the first stop. diagonal_m is the diagonal of the model's bounding box,
 * positive; the speed is proportional to it. */
void tour_path_init(struct tour_path *path, const struct tour_view *stops, uint32_t count,
		    bool closed, float diagonal_m);

struct tour_pose {
	float eye_m[3], target_m[3]; /* one metre apart */
	uint32_t stop;               /* the stop where it stays, or to which it moves next */
	bool moves;
};

/* Writes the pose ms milliseconds after the start. Before the start it is the first pose, after the
 * end the last one. */
void tour_path_pose(const struct tour_path *path, int64_t ms, struct tour_pose *out);
/* Writes the position of the eye at a share, 0 to 1, of the leg's length. */
void tour_path_place(const struct tour_path *path, uint32_t leg, float share, float eye_m[3]);
/* Returns the length of a leg in metres, the turning converted to metres included. */
float tour_path_leg_m(const struct tour_path *path, uint32_t leg);
/* Returns how many milliseconds the camera will still stay at its stop; 0: it is moving, or the
 * tour has ended. */
int64_t tour_path_rest_ms(const struct tour_path *path, int64_t ms);

/* Returns the distance from the path within which the model counts as an obstacle. It is large
 * enough that the near plane of no panel, however wide, reaches the model. diagonal_m as in
 * tour_path_init. */
float tour_path_clearance_m(float diagonal_m);

#endif
