/* Keeps the scenery of the release, and answers touches on it. */
#include "render/scene/scene_scenery.h"

#include <math.h>

#include "base/log.h"
#include "geometry/vec.h"
#include "render/scene/scene_around.h"

int scene_put_scenery(struct scene *scene, struct scenery *scenery)
{
	struct scene_scenery *own = &scene->scenery;
	int rc;

	if (own->is_here)
		return 0;
	own->content = *scenery;
	*scenery = (struct scenery){ 0 };
	rc = pose_init(&own->pose, &own->content);
	if (rc == 0)
		rc = scenery_picture_load(&own->picture, &own->content);
	if (rc < 0) {
		scene_drop_scenery(scene);
		return rc;
	}
	own->is_here = true;
	log_debug("render", "scenery: %u triangles, %u motions, %u layers",
		  scenery_triangles(&own->content), own->content.motion_count,
		  own->content.layer_count);
	return 0;
}

void scene_drop_scenery(struct scene *scene)
{
	struct scene_scenery *own = &scene->scenery;

	scenery_picture_drop(&own->picture);
	pose_finish(&own->pose);
	scenery_finish(&own->content);
	scene_drop_around(scene);
	own->is_here = own->is_ready = own->lacks = false;
}

/* It appears when there are patches to stand on. */
static bool is_shown(const struct scene *scene)
{
	return scene->scenery.is_here && scene->has_hierarchy && scene->geometry.loaded[0];
}

bool scene_step_scenery(struct scene *scene, float passed_ms)
{
	struct scene_scenery *own = &scene->scenery;

	own->moves = is_shown(scene) && own->is_ready && pose_step(&own->pose, passed_ms);
	return own->moves;
}

bool scene_scenery_is_still(const struct scene *scene)
{
	const struct scene_scenery *own = &scene->scenery;

	return !is_shown(scene) || !own->is_ready || (!own->lacks && !own->moves);
}

struct surface_fog scene_fog(const struct scene *scene)
{
	const struct pose *pose = &scene->scenery.pose;
	const struct scenery_fog *fog = &scene->scenery.content.fog;
	struct surface_fog out = { 0 };

	if (!is_shown(scene) || !(fog->range_m > 0))
		return out;
	out.share = pose->appeared;
	if (fog->layer != SCENERY_NONE)
		out.share *= pose->layer_shares[fog->layer];
	out.range_m = fog->range_m;
	out.is_exponential = fog->is_exponential;
	for (int k = 0; k < 3; k++)
		out.rgb[k] = (float)fog->rgb[k] / 255;
	return out;
}

/* Uploads a picture or builds a program of those that are needed for it to appear, with its fog and
 * without. */
static void prepare(struct scene *scene, const struct surface_frame *frame)
{
	struct scene_scenery *own = &scene->scenery;
	struct surface_frame foggy = *frame;

	if ((!own->picture.around && scene_around_waits(scene)) ||
	    !scenery_textures_next(&own->picture.textures, &own->content) ||
	    !scenery_picture_prepare(&own->picture, &own->pose, frame))
		return;
	foggy.fog.share = 1;
	own->is_ready = !(own->content.fog.range_m > 0) ||
			(surface_prepare(&scene->surface, &foggy) &&
			 scenery_picture_prepare(&own->picture, &own->pose, &foggy));
}

void scene_draw_scenery(struct scene *scene, const struct surface_frame *frame)
{
	struct scene_scenery *own = &scene->scenery;

	if (!is_shown(scene) || frame->shares)
		return;
	pose_look(&own->pose, frame->view->eye_m, frame->view->up);
	scenery_picture_bend(&own->picture, &own->pose);
	if (own->is_ready)
		own->lacks = !scenery_picture_draw(&own->picture, &own->pose, frame);
	else if (!scene->programs_wait)
		prepare(scene, frame);
}

void scene_draw_scenery_depths(struct scene *scene)
{
	struct scene_scenery *own = &scene->scenery;
	const struct view *view = &scene->visibility.view;

	if (!is_shown(scene) || !own->is_ready)
		return;
	pose_look(&own->pose, view->eye_m, view->up);
	scenery_picture_bend(&own->picture, &own->pose);
	scenery_picture_depths(&own->picture, &own->pose, &scene->visibility);
}

float scene_scenery_far_m(const struct scene *scene, const float eye_m[3])
{
	return is_shown(scene) ? scenery_picture_far_m(&scene->scenery.pose, eye_m) : 0;
}

uint64_t scene_scenery_bytes(const struct scene *scene)
{
	return scene->scenery.is_here ? scenery_textures_bytes(&scene->scenery.content) : 0;
}

bool scene_scenery_waits(const struct scene *scene)
{
	const struct scene_scenery *own = &scene->scenery;

	return is_shown(scene) && (!own->is_ready || own->lacks || scene_around_waits(scene));
}

uint32_t scene_ray_scenery(const struct scene *scene, const float from_m[3],
			   const float direction[3], float least_m, float *distance_m)
{
	return is_shown(scene)
		       ? scenery_ray(&scene->scenery.pose, from_m, direction, least_m, distance_m)
		       : SCENERY_NONE;
}

/* Returns the node of the scenery under a finger, or SCENERY_NONE: what stands in front of it takes
 * the touch. Sets direction to the finger's ray, and *distance_m to how far it goes. */
static uint32_t node_under(const struct scene *scene, const struct camera *camera, float x_px,
			   float y_px, float direction[3], float *distance_m)
{
	float least = camera->near_m;

	*distance_m = INFINITY;
	camera_ray(camera, x_px, y_px, direction);
	if (!section_clip(&scene->tools.section, camera->eye_m, direction, &least, distance_m))
		return SCENERY_NONE;
	geometry_ray(&scene->geometry, &scene->cut, camera->eye_m, direction, least, distance_m,
		     NULL);
	return scene_ray_scenery(scene, camera->eye_m, direction, least, distance_m);
}

bool scene_touch(struct scene *scene, const struct camera *camera, float x_px, float y_px)
{
	float direction[3], distance;
	uint32_t node;

	if (!is_shown(scene) || scene->scenery.content.touch_count == 0)
		return false;
	node = node_under(scene, camera, x_px, y_px, direction, &distance);
	return node != SCENERY_NONE && pose_touch(&scene->scenery.pose, node);
}

bool scene_grab(struct scene *scene, const struct camera *camera, float x_px, float y_px)
{
	float direction[3], distance, point_m[3];
	uint32_t node;

	if (!is_shown(scene) || scene->scenery.content.drag_count == 0)
		return false;
	node = node_under(scene, camera, x_px, y_px, direction, &distance);
	if (node == SCENERY_NONE)
		return false;
	vec_add_scaled(point_m, camera->eye_m, distance, direction);
	return pose_grab(&scene->scenery.pose, node, point_m, direction);
}

void scene_drag(struct scene *scene, const struct camera *camera, float x_px, float y_px)
{
	float direction[3];

	if (!is_shown(scene))
		return;
	camera_ray(camera, x_px, y_px, direction);
	pose_drag(&scene->scenery.pose, camera->eye_m, direction);
}

void scene_let_go(struct scene *scene)
{
	if (scene->scenery.is_here)
		pose_let_go(&scene->scenery.pose);
}

const struct scenery *scene_scenery(const struct scene *scene)
{
	return is_shown(scene) ? &scene->scenery.content : NULL;
}

uint32_t scene_layer(const struct scene *scene)
{
	return scene->scenery.is_here ? scene->scenery.pose.layer : 0;
}

void scene_choose_layer(struct scene *scene, uint32_t layer)
{
	if (scene->scenery.is_here && layer < scene->scenery.content.layer_count)
		pose_choose(&scene->scenery.pose, layer);
}

void scene_reset_scenery(struct scene *scene)
{
	if (scene->scenery.is_here)
		pose_reset(&scene->scenery.pose);
}
