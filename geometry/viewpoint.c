/* Places the eye on the line from the part to the present eye, at a distance in proportion to the
 * part's size. */
#include "geometry/viewpoint.h"

#include <math.h>

#include "geometry/vec.h"

#define DISTANCE_SIZES 5 /* distance from the part, in sizes of the part */
#define STEEP_MIN      0.05f
#define STEEP_MAX      0.7f

void viewpoint_of_region(const struct region *region, const float anchor_m[3], float least_m,
			 const float from_m[3], float eye_m[3], float target_m[3])
{
	const float size = fmaxf(region_size_m(region), least_m);
	float away[3], distance;

	vec_copy(target_m, anchor_m);
	vec_sub(away, from_m, anchor_m);
	distance = vec_normalise(away);
	if (distance < least_m / 5) {
		away[0] = 0;
		away[1] = -1;
		away[2] = 0.3f;
		vec_normalise(away);
	}
	away[2] = fminf(fmaxf(away[2], STEEP_MIN), STEEP_MAX);
	vec_normalise(away);
	distance = fminf(distance, DISTANCE_SIZES * size);
	vec_add_scaled(eye_m, target_m, distance, away);
}
