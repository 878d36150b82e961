/* Binds the navigator to the scene: bounds and where the eye may be come from it, and fingers pick
 * points of its surface. Also flies to parts, so that they are in the middle of the free area. */
#include "app/view/eye.h"

#include <math.h>
#include <string.h>

#include "base/log.h"
#include "geometry/vec.h"

#define PART_LEAST_M     0.5f  /* smallest size of a part for a flight to it */
#define PART_LEAST_SHARE 0.03f /* on a small model: a share of its diagonal */

enum { FOV_DEG = 45, LOG_MS = 100 };

void eye_init(struct eye *eye, const struct exhibit *shown)
{
	*eye = (struct eye){ .shown = shown };
}

static float reach(void *data, const float from_m[3], const float direction[3], float most_m,
		   int *axis)
{
	const struct eye *eye = data;

	return scene_reach(eye->shown->scene, from_m, direction, most_m,
			   navigator_keep_off_m(&eye->navigator), axis);
}

static const struct solid *solid(void *data)
{
	const struct eye *eye = data;

	return scene_solid(eye->shown->scene);
}

void eye_take_bounds(struct eye *eye)
{
	const struct root_page *root = scene_root(eye->shown->scene);
	struct navigator_options options = {
		.fov_deg = FOV_DEG,
		.reach = reach,
		.solid = solid,
		.data = eye,
	};

	memcpy(options.box_min_m, root->box_min_m, sizeof(options.box_min_m));
	memcpy(options.box_max_m, root->box_max_m, sizeof(options.box_max_m));
	memcpy(options.home_eye_m, root->start_eye_m, sizeof(options.home_eye_m));
	memcpy(options.home_target_m, root->start_target_m, sizeof(options.home_target_m));
	if (eye->ready)
		eye->navigator.options = options;
	else
		navigator_init(&eye->navigator, &options);
	eye->ready = true;
}

void eye_on_release(void *data, const struct exhibit_change *change)
{
	struct eye *eye = data;

	if (change->before->frame.patches == 0)
		eye->ready = false;
}

/* ---- a frame */

void eye_step(struct eye *eye, const struct viewport *viewport, float dt_ms)
{
	eye->moves = navigator_step(&eye->navigator, dt_ms, (float)viewport_height_px(viewport));
}

/* Logs the path of the eye, so that a visit can be replayed with other timing. */
static void log_path(struct eye *eye, int64_t now_ms)
{
	const float *e = eye->camera.eye_m, *t = eye->camera.target_m;

	if (now_ms - eye->logged_ms < LOG_MS ||
	    (memcmp(e, eye->logged.eye_m, sizeof(eye->logged.eye_m)) == 0 &&
	     memcmp(t, eye->logged.target_m, sizeof(eye->logged.target_m)) == 0))
		return;
	eye->logged = eye->camera;
	eye->logged_ms = now_ms;
	log_debug("app", "eye at %.3f %.3f %.3f, looks at %.3f %.3f %.3f", (double)e[0],
		  (double)e[1], (double)e[2], (double)t[0], (double)t[1], (double)t[2]);
}

void eye_aim(struct eye *eye, const struct viewport *viewport, int64_t now_ms)
{
	navigator_camera(&eye->navigator, &eye->camera);
	viewport_set_camera(viewport, &eye->camera);
	log_path(eye, now_ms);
}

void eye_log(const struct eye *eye, const char *when)
{
	const float *eye_m = eye->navigator.eye_m;

	log_debug("app", "%s: eye at %.3f %.3f %.3f", when, (double)eye_m[0], (double)eye_m[1],
		  (double)eye_m[2]);
}

/* ---- fingers */

bool eye_pick(const struct eye *eye, const struct viewport *viewport, float x_px, float y_px,
	      float point_m[3])
{
	const struct navigator_options *o = &eye->navigator.options;
	float direction[3], middle[3];

	viewport_to_panel(viewport, &x_px, &y_px);
	if (scene_pick(eye->shown->scene, &eye->camera, x_px, y_px, point_m))
		return true;
	camera_ray(&eye->camera, x_px, y_px, direction);
	vec_mix(middle, o->box_min_m, o->box_max_m, 0.5f);
	vec_copy(point_m, eye->camera.eye_m);
	vec_add_scaled(point_m, point_m,
		       fmaxf(navigator_keep_off_m(&eye->navigator), vec_distance(middle, point_m)),
		       direction);
	return false;
}

bool eye_measure(const struct eye *eye, const struct viewport *viewport, float x_px, float y_px,
		 float point_m[3], float *error_m)
{
	const struct camera *camera = &eye->camera;
	float half_m;

	viewport_to_panel(viewport, &x_px, &y_px);
	if (!scene_pick_surface(eye->shown->scene, camera, x_px, y_px, point_m, error_m))
		return false;
	half_m = 0.5f * vec_distance(camera->eye_m, point_m) / camera_px_per_radian(camera);
	*error_m = hypotf(*error_m, half_m);
	return true;
}

void eye_grab(struct eye *eye, const struct viewport *viewport, float x_px, float y_px)
{
	float pivot_m[3];

	eye_pick(eye, viewport, x_px, y_px, pivot_m);
	navigator_grab(&eye->navigator, pivot_m);
}

/* ---- flights */

void eye_fly_to_part(struct eye *eye, const struct viewport *viewport, uint32_t part)
{
	const struct rect rect = overlay_scene_rect(exhibit_overlay(eye->shown));
	const float w = (float)viewport_width_px(viewport);
	const float h = (float)viewport_height_px(viewport);
	const float tangent = tanf(eye->navigator.options.fov_deg * (float)M_PI / 360);
	const float side = ((float)rect.x_px + (float)rect.width_px / 2) / w * 2 - 1;
	const float height = 1 - ((float)rect.y_px + (float)rect.height_px / 2) / h * 2;
	const float least =
		fminf(PART_LEAST_M, PART_LEAST_SHARE * navigator_diagonal_m(&eye->navigator));
	float eye_m[3], target[3], forward[3], right[3], up[3], distance;

	information_view_viewpoint(eye->shown->view, part, least, eye->navigator.eye_m, eye_m,
				   target);
	vec_sub(forward, target, eye_m);
	distance = vec_length(forward);
	vec_cross(right, forward, (float[]){ 0, 0, 1 });
	vec_normalise(right);
	vec_cross(up, right, forward);
	vec_normalise(up);
	vec_add_scaled(target, target, -side * tangent * w / h * distance, right);
	vec_add_scaled(target, target, -height * tangent * distance, up);
	navigator_fly(&eye->navigator, eye_m, target, EYE_FLIGHT_MS);
}

void eye_fly_home(struct eye *eye)
{
	const struct navigator_options *o = &eye->navigator.options;

	navigator_fly(&eye->navigator, o->home_eye_m, o->home_target_m, EYE_FLIGHT_MS);
}
