/* Matrices, rays and projected pixels of a camera, computed with cglm. */
#include "geometry/camera.h"

#include <math.h>
#include <string.h>

#include <cglm/cglm.h>

static bool is_sideways(const struct camera *camera)
{
	return camera->rotation_deg % 180 != 0;
}

float camera_aspect(const struct camera *camera)
{
	float ratio = (float)camera->width_px / (float)camera->height_px;

	return is_sideways(camera) ? 1 / ratio : ratio;
}

float camera_px_per_radian(const struct camera *camera)
{
	int seen_height = is_sideways(camera) ? camera->width_px : camera->height_px;

	return (float)seen_height / (2 * tanf(glm_rad(camera->fov_deg) / 2));
}

static void view_of(const struct camera *camera, mat4 out)
{
	vec3 eye, target, up, forward, side;

	memcpy(eye, camera->eye_m, sizeof(eye));
	memcpy(target, camera->target_m, sizeof(target));
	memcpy(up, camera->up, sizeof(up));
	glm_vec3_sub(target, eye, forward);
	glm_vec3_normalize(forward);
	glm_vec3_normalize(up);
	glm_vec3_cross(forward, up, side);
	if (glm_vec3_norm(side) < 1e-4f) /* straight up or down: any fixed up vector will do */
		glm_vec3_copy(fabsf(forward[1]) < 0.9f ? (vec3){ 0, 1, 0 } : (vec3){ 0, 0, 1 }, up);
	glm_look(eye, forward, up, out);
}

static void projection_of(const struct camera *camera, mat4 out)
{
	mat4 perspective, turn;

	glm_perspective(glm_rad(camera->fov_deg), camera_aspect(camera), camera->near_m,
			camera->far_m, perspective);
	/* Quarter turns are exact; a cosine would be nearly, but not quite, zero. */
	glm_mat4_identity(turn);
	for (int deg = camera->rotation_deg; deg > 0; deg -= 90) {
		mat4 quarter = { { 0, 1, 0, 0 }, { -1, 0, 0, 0 }, { 0, 0, 1, 0 }, { 0, 0, 0, 1 } };

		glm_mat4_mul(quarter, turn, turn);
	}
	glm_mat4_mul(turn, perspective, out);
}

void camera_view(const struct camera *camera, float out[16])
{
	mat4 view;

	view_of(camera, view);
	memcpy(out, view, sizeof(view));
}

void camera_projection(const struct camera *camera, float out[16])
{
	mat4 projection;

	projection_of(camera, projection);
	memcpy(out, projection, sizeof(projection));
}

void camera_matrix(const struct camera *camera, float out[16])
{
	mat4 view, projection, both;

	view_of(camera, view);
	projection_of(camera, projection);
	glm_mat4_mul(projection, view, both);
	memcpy(out, both, sizeof(both));
}

void camera_ray(const struct camera *camera, float x_px, float y_px, float direction[3])
{
	mat4 view;
	float x = 2 * x_px / (float)camera->width_px - 1;
	float y = 1 - 2 * y_px / (float)camera->height_px;
	float tangent = tanf(glm_rad(camera->fov_deg) / 2);
	vec3 ray;

	/* undo the rotation of the projection */
	for (int deg = camera->rotation_deg; deg > 0; deg -= 90) {
		float was_x = x;

		x = y;
		y = -was_x;
	}
	view_of(camera, view);
	for (int i = 0; i < 3; i++) /* the rows of the view matrix are the axes of the eye */
		ray[i] = x * tangent * camera_aspect(camera) * view[i][0] +
			 y * tangent * view[i][1] - view[i][2];
	glm_vec3_normalize(ray);
	memcpy(direction, ray, sizeof(ray));
}

bool camera_pixel(const struct camera *camera, const float point_m[3], float *x_px, float *y_px)
{
	vec4 point = { point_m[0], point_m[1], point_m[2], 1 }, clip;
	mat4 view, projection, both;

	view_of(camera, view);
	projection_of(camera, projection);
	glm_mat4_mul(projection, view, both);
	glm_mat4_mulv(both, point, clip);
	if (!(clip[3] > 0))
		return false;
	*x_px = (clip[0] / clip[3] + 1) / 2 * (float)camera->width_px;
	*y_px = (1 - clip[1] / clip[3]) / 2 * (float)camera->height_px;
	return true;
}
