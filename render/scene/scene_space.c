/* Rays against the shown surface; and how far an eye may go: by the release's octree, or by rays
 * where there is none. */
#include "render/scene/scene_space.h"

#include <math.h>
#include <string.h>

#include "geometry/solid_space.h"
#include "geometry/vec.h"
#include "render/scene/scene_scenery.h"

/* The shown surface is off the scan's by a 22nd of the triangles' sides at most, as a root mean
 * square, in all levels of all scans that were measured (docs/tools.md). */
#define SPACINGS_AN_ERROR 22.0f

static float error_of(const struct scene *scene, const struct geometry_hit *hit)
{
	const struct patch_bvh *bvh = &scene->geometry.patches[hit->patch].content.bvh;
	uint32_t piece = 0;

	while (piece + 1 < bvh->piece_count &&
	       bvh->pieces[piece + 1].first_triangle <= hit->on.triangle)
		piece++;
	return bvh->pieces[piece].spacing_m / SPACINGS_AN_ERROR;
}

bool scene_pick(struct scene *scene, const struct camera *camera, float x_px, float y_px,
		float point_m[3])
{
	float error_m;

	return scene_pick_surface(scene, camera, x_px, y_px, point_m, &error_m);
}

bool scene_pick_surface(struct scene *scene, const struct camera *camera, float x_px, float y_px,
			float point_m[3], float *error_m)
{
	struct geometry_hit hit;
	bool on_scan, on_scenery;
	float direction[3], distance = INFINITY, least = camera->near_m;
	if (!scene->has_hierarchy)
		return false;
	camera_ray(camera, x_px, y_px, direction);
	if (!section_clip(&scene->tools.section, camera->eye_m, direction, &least, &distance))
		return false;
	on_scan = geometry_ray(&scene->geometry, &scene->cut, camera->eye_m, direction, least,
			       &distance, &hit);
	on_scenery = scene_ray_scenery(scene, camera->eye_m, direction, least, &distance) !=
		     SCENERY_NONE;
	if (!on_scan && !on_scenery)
		return false;
	*error_m = on_scenery ? 0 : error_of(scene, &hit);
	vec_add_scaled(point_m, camera->eye_m, distance, direction);
	return true;
}

float scene_clearance(struct scene *scene, const float from_m[3], const float direction[3],
		      float most_m)
{
	float unit[3], distance = most_m, least = 0;
	memcpy(unit, direction, sizeof(unit));
	if (!scene->has_hierarchy || vec_normalise(unit) <= 0 ||
	    !section_clip(&scene->tools.section, from_m, unit, &least, &distance))
		return INFINITY;
	return geometry_ray(&scene->geometry, &scene->cut, from_m, unit, least, &distance, NULL)
		       ? distance
		       : INFINITY;
}

void scene_put_solid(struct scene *scene, struct solid *solid)
{
	solid_finish(&scene->solid);
	scene->solid = *solid;
	*solid = (struct solid){ .nodes = NULL };
	scene->wants_are_stale = true;
}

const struct solid *scene_solid(const struct scene *scene)
{
	return scene->solid.nodes ? &scene->solid : NULL;
}

float scene_reach(struct scene *scene, const float from_m[3], const float direction[3],
		  float most_m, float room_m, int *axis)
{
	float least = 0, most = most_m, kept_m[3];
	*axis = -1;
	if (!scene->solid.nodes) {
		/* The release has no octree, or it is not here yet. */
		float free_m = scene_clearance(scene, from_m, direction, most_m + room_m);
		return isinf(free_m) ? free_m : vec_most(0, free_m - room_m);
	}
	/* An eye may be where the stone is cut away. */
	if (!section_clip(&scene->tools.section, from_m, direction, &least, &most))
		return INFINITY;
	vec_copy(kept_m, from_m);
	vec_add_scaled(kept_m, kept_m, least, direction);
	return least + solid_reach(&scene->solid, kept_m, direction, most - least, axis);
}
