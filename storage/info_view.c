#include "storage/info_view.h"

#include <math.h>

#define DISTANCE_SIZES 5 /* of the part, from it */
#define STEEP_MIN      0.05f
#define STEEP_MAX      0.7f

float info_region_size_m(const struct info_region *region)
{
	float most = 0;

	switch (region->kind) {
	case INFO_REGION_POINT: /* one of a list of faces has their radius */
	case INFO_REGION_SPHERE:
		return region->radius_m;
	case INFO_REGION_BOX:
		return cbrtf(region->half_m[0] * region->half_m[1] * region->half_m[2]);
	case INFO_REGION_PRISM:
		for (uint32_t i = 0; i < region->corner_count; i++)
			most = fmaxf(most,
				     hypotf(region->corners_m[i][0] - region->corners_m[0][0],
					    region->corners_m[i][1] - region->corners_m[0][1]));
		return cbrtf(most * most * (region->roof_m - region->floor_m)) / 2;
	}
	return 0;
}

/* Its length before. */
static float make_unit(float v[3])
{
	const float length = sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);

	for (int i = 0; i < 3 && length > 0; i++)
		v[i] /= length;
	return length;
}

void info_view(const struct info_region *region, const float anchor_m[3], float least_m,
	       const float from_m[3], float eye_m[3], float target_m[3])
{
	const float size = fmaxf(info_region_size_m(region), least_m);
	float away[3], distance;

	for (int i = 0; i < 3; i++) {
		away[i] = from_m[i] - anchor_m[i];
		target_m[i] = anchor_m[i];
	}
	distance = make_unit(away);
	if (distance < least_m / 5) {
		away[0] = 0;
		away[1] = -1;
		away[2] = 0.3f;
		make_unit(away);
	}
	away[2] = fminf(fmaxf(away[2], STEEP_MIN), STEEP_MAX);
	make_unit(away);
	distance = fminf(distance, DISTANCE_SIZES * size);
	for (int i = 0; i < 3; i++)
		eye_m[i] = target_m[i] + distance * away[i];
}
