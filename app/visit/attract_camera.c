/* Computes the camera path around the model while nobody is there: the first pose turned about the
 * vertical axis, with an eased move between resting places. */
#include "app/visit/attract_camera.h"

#include <math.h>
#include <string.h>

#define CLEAR_SHARE 0.6f /* of the box's diagonal in plan: the circle then lies around the box */

enum { PLACE_MS = ATTRACT_CAMERA_REST_MS + ATTRACT_CAMERA_MOVE_MS };

void attract_camera_init(struct attract_camera *attract, const float box_min_m[3],
			 const float box_max_m[3], const float home_eye_m[3],
			 const float home_target_m[3])
{
	const float least_m =
		CLEAR_SHARE * hypotf(box_max_m[0] - box_min_m[0], box_max_m[1] - box_min_m[1]);
	float out_m[2], distance_m;

	for (int i = 0; i < 2; i++) {
		attract->axis_m[i] = (box_min_m[i] + box_max_m[i]) / 2;
		out_m[i] = home_eye_m[i] - attract->axis_m[i];
	}
	memcpy(attract->eye_m, home_eye_m, sizeof(attract->eye_m));
	memcpy(attract->target_m, home_target_m, sizeof(attract->target_m));
	distance_m = hypotf(out_m[0], out_m[1]);
	if (distance_m >= least_m)
		return;
	/* A first view from inside or above is no use for a path around the model: start on the
	 * circle instead. */
	if (distance_m < least_m / 100) {
		out_m[0] = 0;
		out_m[1] = -(distance_m = 1);
	}
	for (int i = 0; i < 2; i++) {
		attract->eye_m[i] = attract->axis_m[i] + out_m[i] / distance_m * least_m;
		attract->target_m[i] = attract->axis_m[i];
	}
	attract->target_m[2] = (box_min_m[2] + box_max_m[2]) / 2;
	attract->eye_m[2] = fmaxf(home_eye_m[2], attract->target_m[2]);
}

static void turn(const struct attract_camera *attract, float angle, const float from_m[3],
		 float out_m[3])
{
	const float x = from_m[0] - attract->axis_m[0], y = from_m[1] - attract->axis_m[1];

	out_m[0] = attract->axis_m[0] + x * cosf(angle) - y * sinf(angle);
	out_m[1] = attract->axis_m[1] + x * sinf(angle) + y * cosf(angle);
	out_m[2] = from_m[2];
}

bool attract_camera_pose(const struct attract_camera *attract, int64_t ms, float eye_m[3],
			 float target_m[3])
{
	const int64_t place = ms / PLACE_MS, since = ms % PLACE_MS - ATTRACT_CAMERA_REST_MS;
	const float part = since > 0 ? (float)since / ATTRACT_CAMERA_MOVE_MS : 0;
	const float eased = part * part * (3 - 2 * part);
	const float angle = ((float)(place % ATTRACT_CAMERA_PLACES) + eased) * 2 * (float)M_PI /
			    ATTRACT_CAMERA_PLACES;

	turn(attract, angle, attract->eye_m, eye_m);
	turn(attract, angle, attract->target_m, target_m);
	return since > 0;
}

int attract_camera_rest_ms(int64_t ms)
{
	const int64_t left = ATTRACT_CAMERA_REST_MS - ms % PLACE_MS;

	return left > 0 ? (int)left : 0;
}
