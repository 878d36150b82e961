/* The eye's way while nobody is there: slowly about the model's vertical axis, from one resting
 * place to the next, as far from it as the release's first view is and never within the circle
 * round the model, so that no wall is in the way. Pure geometry. */
#ifndef GOPURA_APP_VISIT_ATTRACT_CAMERA_H
#define GOPURA_APP_VISIT_ATTRACT_CAMERA_H

#include <stdbool.h>
#include <stdint.h>

enum {
	ROAM_PLACES = 8, /* on the way round */
	ROAM_REST_MS = 9000,
	ROAM_MOVE_MS = 14000,
};

struct roam {
	float axis_m[2]; /* x, y */
	float eye_m[3], target_m[3];
};

void roam_init(struct roam *roam, const float box_min_m[3], const float box_max_m[3],
	       const float home_eye_m[3], const float home_target_m[3]);
/* Where the eye is so long after it began. true: it moves then. */
bool roam_pose(const struct roam *roam, int64_t ms, float eye_m[3], float target_m[3]);
/* Until it moves on; 0: it moves. */
int roam_rest_ms(int64_t ms);

#endif
