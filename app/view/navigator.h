/* Moves the eye as fingers ask. The pivot is the surface point that was touched: one finger turns
 * about it; two fingers zoom towards it, pan with it and rotate about it. It stays under the
 * fingers. A fling continues after the finger has left and slows down. The eye stays in its allowed
 * space: outside of solid matter, above the ground, and near the model. On foot it stays at the
 * height of somebody who stands: one finger looks around, two fingers step to and fro. A flight
 * leads through doors and around walls; where no way is found, the eye is at its end at once.
 *
 * Pure except for the callbacks: no time, no scene, no GL. */
#ifndef GOPURA_APP_VIEW_NAVIGATOR_H
#define GOPURA_APP_VIEW_NAVIGATOR_H

#include "geometry/camera.h"
#include "geometry/solid_way.h"

#include <stdbool.h>

struct navigator_options {
	float box_min_m[3], box_max_m[3]; /* bounding box of the model */
	float home_eye_m[3], home_target_m[3];
	float fov_deg; /* vertical */
	/* Returns how far the eye may go from a point along a unit direction: 0: no farther,
	 * INFINITY: at least most_m. *axis becomes the axis across which it is held up, or -1.
	 * NULL: no obstacles. */
	float (*reach)(void *data, const float from_m[3], const float direction[3], float most_m,
		       int *axis);
	/* Returns the octree by which flights are planned, borrowed for the call of the navigator
	 * that asks; NULL: there is none. NULL: there is never one. */
	const struct solid *(*solid)(void *data);
	void *data;
};

struct navigator {
	struct navigator_options options;
	float eye_m[3];
	float yaw, pitch; /* direction of view, radians; yaw 0 looks along +x, positive pitch looks
			     up */
	float pivot_m[3];
	float fling_px_s[2];
	bool on_foot;

	/* A flight to another pose; flight_left_ms is 0 if there is none. */
	float flight_left_ms, flight_ms;
	struct solid_way way;
	float from_yaw, to_yaw, from_pitch, to_pitch;
	bool walks; /* the flight is a walk, and looks where it goes */
};

/* Copies *options and puts the eye at their home pose. */
void navigator_init(struct navigator *nav, const struct navigator_options *options);

/* Call it when a finger comes down on this surface point. Stops flings and flights. */
void navigator_grab(struct navigator *nav, const float pivot_m[3]);
/* One finger moved by that many pixels. height_px: of the panel; half of it turns the view by 90
 * degrees. */
void navigator_turn(struct navigator *nav, float dx_px, float dy_px, float height_px);
/* Two fingers moved. scale: > 1 if they moved apart; limited to 0.2 to 5. dx_px, dy_px: pan in
 * panel pixels; twist: radians, clockwise. */
void navigator_pinch(struct navigator *nav, float scale, float dx_px, float dy_px, float twist,
		     float height_px);
/* The finger left with this speed, which goes on as a fling. */
void navigator_fling(struct navigator *nav, float vx_px_s, float vy_px_s);
/* Flies smoothly to a pose, or as near to it as an eye may be, around obstacles; a touch stops it.
 * Without a way the next step is there. duration_ms: for the straight path; a longer path takes
 * proportionally longer, at most twice that time. */
void navigator_fly(struct navigator *nav, const float eye_m[3], const float target_m[3],
		   float duration_ms);
/* Says whether fingers move somebody who walks, from now on. Nothing moves. In the air, and
 * without an octree, they move the eye as ever. */
void navigator_set_on_foot(struct navigator *nav, bool on_foot);
/* Walks to a touched point of a floor, or before what else was touched, as near as there is a way;
 * from where nobody stands it flies there. Returns false if it cannot; the eye then stays. */
bool navigator_walk(struct navigator *nav, const float touched_m[3]);
/* Writes the pose that the eye has, or flies to. */
void navigator_goal(const struct navigator *nav, float eye_m[3], float target_m[3]);
/* Returns whether the eye flies, or nobody has moved it since its last flight arrived. */
bool navigator_is_left_alone(const struct navigator *nav);
/* Moves the eye to a pose at once. Stops flings and flights. */
void navigator_look(struct navigator *nav, const float eye_m[3], const float target_m[3]);

/* Advances flight or fling by dt_ms milliseconds. Returns true while the eye moves by itself. */
bool navigator_step(struct navigator *nav, float dt_ms, float height_px);
/* Returns the diagonal of the model's bounding box, in metres. */
float navigator_diagonal_m(const struct navigator *nav);
/* Returns how close the eye may come to a surface, in metres. */
float navigator_keep_off_m(const struct navigator *nav);
/* Sets eye, target, up, field of view and clip distances of *camera; leaves the panel's fields. */
void navigator_camera(const struct navigator *nav, struct camera *camera);

#endif
