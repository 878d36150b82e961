/* Derives the axes, the matrix and the frustum planes of a view, and tests spheres against them. */
#include "geometry/view.h"

#include <math.h>
#include <string.h>

#include "geometry/vec.h"

static void set_matrix(struct view *view, const struct camera *camera)
{
	float turn[16], projection[16];
	camera_view(camera, turn);
	camera_projection(camera, projection);
	for (int i = 0; i < 3; i++) {
		view->right[i] = turn[4 * i];
		view->up[i] = turn[4 * i + 1];
		view->forward[i] = -turn[4 * i + 2];
	}
	/* Relative to the eye the view matrix is a rotation only, which stays precise however far
	 * the model is from the origin. */
	turn[12] = turn[13] = turn[14] = 0;
	matrix_multiply(view->clip, projection, turn);
}

static void set_sides(struct view *view)
{
	float cx = 1 / sqrtf(1 + view->tan_x * view->tan_x), sx = view->tan_x * cx;
	float cy = 1 / sqrtf(1 + view->tan_y * view->tan_y), sy = view->tan_y * cy;
	for (int i = 0; i < 3; i++) {
		view->side_normal[0][i] = sx * view->forward[i] + cx * view->right[i];
		view->side_normal[1][i] = sx * view->forward[i] - cx * view->right[i];
		view->side_normal[2][i] = sy * view->forward[i] + cy * view->up[i];
		view->side_normal[3][i] = sy * view->forward[i] - cy * view->up[i];
	}
}

void view_from_camera(struct view *view, const struct camera *camera)
{
	memset(view, 0, sizeof(*view));
	memcpy(view->eye_m, camera->eye_m, sizeof(view->eye_m));
	view->width_px = camera->width_px;
	view->height_px = camera->height_px;
	view->tan_y = tanf(camera->fov_deg * (float)M_PI / 360);
	view->tan_x = view->tan_y * camera_aspect(camera);
	view->focal_px = camera_px_per_radian(camera);
	view->picture_px = (float)camera->width_px * (float)camera->height_px;
	set_matrix(view, camera);
	set_sides(view);
	view->cut[3] = 1;
}

void view_jitter(struct view *view, float x_px, float y_px)
{
	for (int i = 0; i < 4; i++) {
		view->clip[4 * i + 0] += 2 * x_px / (float)view->width_px * view->clip[4 * i + 3];
		view->clip[4 * i + 1] += 2 * y_px / (float)view->height_px * view->clip[4 * i + 3];
	}
}

bool view_is_cut(const struct view *view)
{
	return view->cut[0] != 0 || view->cut[1] != 0 || view->cut[2] != 0;
}

bool view_sees_sphere(const struct view *view, const float centre_m[3], float radius_m)
{
	float to[3];
	vec_sub(to, centre_m, view->eye_m);
	for (int i = 0; i < 4; i++)
		if (vec_dot(to, view->side_normal[i]) < -radius_m)
			return false;
	if (view_is_cut(view) && vec_dot(to, view->cut) > view->cut[3] + radius_m)
		return false;
	return vec_dot(to, view->forward) > -radius_m;
}

float view_sphere_distance(const struct view *view, const float centre_m[3], float radius_m)
{
	float distance = vec_distance(centre_m, view->eye_m) - radius_m;
	return distance > 0 ? distance : 0;
}

float view_sphere_px(const struct view *view, const float centre_m[3], float radius_m)
{
	float distance = vec_distance(centre_m, view->eye_m);
	if (distance <= radius_m)
		return view->picture_px;
	float radius_px = radius_m * view->focal_px / distance;
	float area = (float)M_PI * radius_px * radius_px;
	return area < view->picture_px ? area : view->picture_px;
}
