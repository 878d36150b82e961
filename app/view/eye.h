/* The visitor's eye: the navigator that moves it, bound to the model of the release that is shown,
 * and the camera of the last frame. */
#ifndef GOPURA_APP_VIEW_EYE_H
#define GOPURA_APP_VIEW_EYE_H

#include "app/view/exhibit.h"
#include "app/view/navigator.h"
#include "app/view/viewport.h"

enum { EYE_FLIGHT_MS = 900 }; /* of the flights that a tap asks for */

struct eye {
	const struct exhibit *shown;
	struct navigator navigator;
	bool ready;           /* a release is loaded, so its bounding box is known */
	bool moves;           /* it moved by itself in the last frame */
	struct camera camera; /* of the last frame */
	struct camera logged; /* the one that was logged last */
	int64_t logged_ms;
};

/* shown is borrowed for the eye's life. */
void eye_init(struct eye *eye, const struct exhibit *shown);
/* Takes the bounds from the root page of the release that is shown, which has arrived. With the
 * first release the eye goes to its start pose; after an update it stays where the visitor has it.
 */
void eye_take_bounds(struct eye *eye);
/* Another release is shown. If nothing was visible of the one before, the eye has no place to keep.
 * data is the eye. */
void eye_on_release(void *data, const struct exhibit_change *change);

/* Advances flight or fling by dt_ms and sets `moves`. */
void eye_step(struct eye *eye, const struct viewport *viewport, float dt_ms);
/* Sets the camera of the frame from navigator and viewport, and logs where it is. */
void eye_aim(struct eye *eye, const struct viewport *viewport, int64_t now_ms);
/* Logs the eye's position after the text `when`. */
void eye_log(const struct eye *eye, const char *when);

/* Finds the surface point under a finger, in the visitor's pixels. If the ray hits nothing, point_m
 * is the point on the ray at the distance of the model's centre, and the result is false. */
bool eye_pick(const struct eye *eye, const struct viewport *viewport, float x_px, float y_px,
	      float point_m[3]);
/* Finds the surface point under a finger, and by how much it is beside the surface of the scan: by
 * the detail that is shown (scene_pick_surface) and half a pixel. Returns false where
 * nothing is. */
bool eye_measure(const struct eye *eye, const struct viewport *viewport, float x_px, float y_px,
		 float point_m[3], float *error_m);
/* Grabs the surface point under a finger, in the visitor's pixels. */
void eye_grab(struct eye *eye, const struct viewport *viewport, float x_px, float y_px);
/* Flies to a pose in which the part is in the middle of the area that the overlay leaves free. */
void eye_fly_to_part(struct eye *eye, const struct viewport *viewport, uint32_t part);
/* Flies to the start pose of the release. */
void eye_fly_home(struct eye *eye);

#endif
