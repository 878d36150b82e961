/* Signed distances to spheres, turned boxes and prisms; the other queries are built on them. */
#include "geometry/region.h"

#include <math.h>

#include "geometry/vec.h"

/* Returns the distance to the polygon's edge, negative inside (by counting crossings). */
static float polygon_distance(const struct region *region, float x, float y)
{
	float nearest = INFINITY;
	bool inside = false;
	for (uint32_t i = 0, j = region->corner_count - 1; i < region->corner_count; j = i++) {
		const float *a = region->corners_m[j], *b = region->corners_m[i];
		float ex = b[0] - a[0], ey = b[1] - a[1], px = x - a[0], py = y - a[1];
		float along = (px * ex + py * ey) / fmaxf(ex * ex + ey * ey, 1e-12f);
		along = fminf(fmaxf(along, 0), 1);
		float dx = px - along * ex, dy = py - along * ey;
		nearest = fminf(nearest, dx * dx + dy * dy);
		if ((a[1] > y) != (b[1] > y) && px < (y - a[1]) / ey * ex)
			inside = !inside;
	}
	return inside ? -sqrtf(nearest) : sqrtf(nearest);
}

static float box_distance(const struct region *region, const float point[3])
{
	float turn = region->turn_deg * (float)M_PI / 180, c = cosf(turn), s = sinf(turn), p[3];
	vec_sub(p, point, region->centre_m);
	float x = c * p[0] + s * p[1], y = c * p[1] - s * p[0];
	return fmaxf(fabsf(p[2]) - region->half_m[2],
		     fmaxf(fabsf(x) - region->half_m[0], fabsf(y) - region->half_m[1]));
}

float region_distance(const struct region *region, const float point_m[3])
{
	switch (region->kind) {
	case REGION_SPHERE:
		return vec_distance(point_m, region->centre_m) - region->radius_m;
	case REGION_BOX:
		return box_distance(region, point_m);
	case REGION_PRISM:
		if (region->corner_count < 3 || region->corner_count > REGION_CORNERS_MAX)
			return INFINITY;
		return fmaxf(polygon_distance(region, point_m[0], point_m[1]),
			     fmaxf(region->floor_m - point_m[2], point_m[2] - region->roof_m));
	case REGION_POINT:
		break;
	}
	return INFINITY;
}

bool region_contains(const struct region *region, const float point_m[3])
{
	return region_distance(region, point_m) <= 0;
}

bool region_meets_sphere(const struct region *region, const float centre_m[3], float radius_m)
{
	return region_distance(region, centre_m) <= radius_m;
}

float region_size_m(const struct region *region)
{
	float most = 0;

	switch (region->kind) {
	case REGION_POINT: /* a point that stands for a list of faces has their radius */
	case REGION_SPHERE:
		return region->radius_m;
	case REGION_BOX:
		return cbrtf(region->half_m[0] * region->half_m[1] * region->half_m[2]);
	case REGION_PRISM:
		for (uint32_t i = 0; i < region->corner_count; i++)
			most = fmaxf(most,
				     hypotf(region->corners_m[i][0] - region->corners_m[0][0],
					    region->corners_m[i][1] - region->corners_m[0][1]));
		return cbrtf(most * most * (region->roof_m - region->floor_m)) / 2;
	}
	return 0;
}
