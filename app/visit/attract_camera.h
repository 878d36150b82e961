/* The eye's way while nobody is there: slowly about the model's vertical axis, from one resting
 * place to the next, as far from it as the release's first view is and never within the circle
 * round the model, so that no wall is in the way. Pure geometry. */
#ifndef GOPURA_APP_VISIT_ATTRACT_CAMERA_H
#define GOPURA_APP_VISIT_ATTRACT_CAMERA_H

#include <stdbool.h>
#include <stdint.h>

enum {
	ATTRACT_CAMERA_PLACES = 8, /* on the way round */
	ATTRACT_CAMERA_REST_MS = 9000,
	ATTRACT_CAMERA_MOVE_MS = 14000,
};

struct attract_camera {
	float axis_m[2]; /* x, y */
	float eye_m[3], target_m[3];
};

void attract_camera_init(struct attract_camera *attract, const float box_min_m[3],
			 const float box_max_m[3], const float home_eye_m[3],
			 const float home_target_m[3]);
/* Where the eye is so long after it began. true: it moves then. */
bool attract_camera_pose(const struct attract_camera *attract, int64_t ms, float eye_m[3],
			 float target_m[3]);
/* Until it moves on; 0: it moves. */
int attract_camera_rest_ms(int64_t ms);

#endif
