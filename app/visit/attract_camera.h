/* The camera path while nobody is there: slowly around the model's vertical axis, from one resting
 * place to the next. Its distance is that of the release's first view, but at least the radius of a
 * circle around the model, so that no wall is in the way. Pure geometry. */
#ifndef GOPURA_APP_VISIT_ATTRACT_CAMERA_H
#define GOPURA_APP_VISIT_ATTRACT_CAMERA_H

#include <stdbool.h>
#include <stdint.h>

enum {
	ATTRACT_CAMERA_PLACES = 8, /* resting places of a full circle */
	ATTRACT_CAMERA_REST_MS = 9000,
	ATTRACT_CAMERA_MOVE_MS = 14000,
};

struct attract_camera {
	float axis_m[2]; /* x, y of the vertical axis */
	float eye_m[3], target_m[3];
};

/* Sets up the path from the model's bounding box and the first view. */
void attract_camera_init(struct attract_camera *attract, const float box_min_m[3],
			 const float box_max_m[3], const float home_eye_m[3],
			 const float home_target_m[3]);
/* Writes the pose that the eye has ms milliseconds after the path began. Returns true if it is
 * moving then. */
bool attract_camera_pose(const struct attract_camera *attract, int64_t ms, float eye_m[3],
			 float target_m[3]);
/* Returns the milliseconds until the eye moves on; 0: it is moving. ms as above; it may be
 * negative, before the path begins. */
int attract_camera_rest_ms(int64_t ms);

#endif
