/* Moves the eye as fingers ask. The pivot is the surface point that was touched: one finger turns
 * about it, two pinch towards it, pan with it and twist around it, and it stays under the fingers.
 * A fling goes on by itself and slows down. The eye stays in the space it may be in: out of solid
 * matter (by the clearance the scene reports), above the ground, near the model.
 *
 * Pure but for the clearance callback: no time, no scene, no GL. */
#ifndef GOPURA_APP_NAVIGATOR_H
#define GOPURA_APP_NAVIGATOR_H

#include "app/flight_way.h"
#include "geometry/camera.h"

#include <stdbool.h>

struct navigator_options {
	float box_min_m[3], box_max_m[3]; /* of the model */
	float home_eye_m[3], home_target_m[3];
	float fov_deg; /* vertical */
	/* Free distance from a point along a unit direction, at most most_m; NULL: all is free. */
	float (*clearance)(void *data, const float from_m[3], const float direction[3],
			   float most_m);
	void *data;
};

struct navigator {
	struct navigator_options options;
	float eye_m[3];
	float yaw, pitch; /* of the view, radians; yaw 0 looks along +x, pitch up is positive */
	float pivot_m[3];
	float fling_px_s[2];

	/* A flight to another pose; ends when flight_left_ms is 0. */
	float flight_left_ms, flight_ms;
	struct flight_way way;
	float from_yaw, to_yaw, from_pitch, to_pitch;
};

/* The eye stands at the options' home. */
void navigator_init(struct navigator *nav, const struct navigator_options *options);

/* A finger came down on this surface point. Stops flings and flights. */
void navigator_grab(struct navigator *nav, const float pivot_m[3]);
/* One finger moved. height_px: of the panel; half of it turns by 90 degrees. */
void navigator_turn(struct navigator *nav, float dx_px, float dy_px, float height_px);
/* Two fingers: scale > 1 when they part; pan in panel pixels; twist in radians, clockwise. */
void navigator_pinch(struct navigator *nav, float scale, float dx_px, float dy_px, float twist,
		     float height_px);
/* The finger left with this speed. */
void navigator_fling(struct navigator *nav, float vx_px_s, float vy_px_s);
/* Smoothly to a pose, round what is in the way where that can be; a touch stops it. duration_ms:
 * of the straight way; a bow takes as much longer as it is. */
void navigator_fly(struct navigator *nav, const float eye_m[3], const float target_m[3],
		   float duration_ms);
/* Where it stands and looks, or flies to. */
void navigator_goal(const struct navigator *nav, float eye_m[3], float target_m[3]);
/* It flies, or nobody has moved it since it arrived. */
bool navigator_is_left_alone(const struct navigator *nav);
/* At once to a pose; ends flings and flights. */
void navigator_look(struct navigator *nav, const float eye_m[3], const float target_m[3]);

/* Lets time pass. true while the eye moves by itself. */
bool navigator_step(struct navigator *nav, float dt_ms, float height_px);
/* Of the model's box. */
float navigator_diagonal_m(const struct navigator *nav);
/* How near the eye may come to a surface; what is nearer to the model than this touches it. */
float navigator_keep_off_m(const struct navigator *nav);
/* Fills eye, target, up, field of view and clip distances; leaves the panel's fields. */
void navigator_camera(const struct navigator *nav, struct camera *camera);

#endif
