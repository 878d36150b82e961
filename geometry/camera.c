/* Matrices, rays and projected pixels of a camera. */
#include "geometry/camera.h"

#include <math.h>
#include <string.h>

#include "geometry/vec.h"

static bool is_sideways(const struct camera *camera)
{
	return camera->rotation_deg % 180 != 0;
}

float camera_aspect(const struct camera *camera)
{
	float ratio = (float)camera->width_px / (float)camera->height_px;

	return is_sideways(camera) ? 1 / ratio : ratio;
}

/* Returns the tangent of half the vertical field of view. */
static float tangent_of(const struct camera *camera)
{
	return tanf(camera->fov_deg * (float)M_PI / 360);
}

float camera_px_per_radian(const struct camera *camera)
{
	int seen_height = is_sideways(camera) ? camera->width_px : camera->height_px;

	return (float)seen_height / (2 * tangent_of(camera));
}

void camera_forward(const struct camera *camera, float out[3])
{
	vec_sub(out, camera->target_m, camera->eye_m);
	vec_normalise(out);
}

/* Writes the eye's axes, unit vectors perpendicular to one another. */
static void axes_of(const struct camera *camera, float right[3], float up[3], float forward[3])
{
	camera_forward(camera, forward);
	vec_copy(up, camera->up);
	vec_normalise(up);
	vec_cross(right, forward, up);
	if (vec_length(right) < 1e-4f) { /* straight up or down: any fixed up vector will do */
		vec_copy(up,
			 fabsf(forward[1]) < 0.9f ? (float[]){ 0, 1, 0 } : (float[]){ 0, 0, 1 });
		vec_cross(right, forward, up);
	}
	vec_normalise(right);
	vec_cross(up, right, forward);
}

void camera_view(const struct camera *camera, float out[16])
{
	float right[3], up[3], forward[3];

	axes_of(camera, right, up, forward);
	for (int i = 0; i < 3; i++) {
		out[4 * i] = right[i];
		out[4 * i + 1] = up[i];
		out[4 * i + 2] = -forward[i];
		out[4 * i + 3] = 0;
	}
	out[12] = -vec_dot(right, camera->eye_m);
	out[13] = -vec_dot(up, camera->eye_m);
	out[14] = vec_dot(forward, camera->eye_m);
	out[15] = 1;
}

void camera_projection(const struct camera *camera, float out[16])
{
	/* Quarter turns are exact; a cosine would be nearly, but not quite, zero. */
	static const float cosine[] = { 1, 0, -1, 0 }, sine[] = { 0, 1, 0, -1 };
	const int quarter = camera->rotation_deg / 90;
	const float scale_y = 1 / tangent_of(camera), scale_x = scale_y / camera_aspect(camera);
	const float near_m = camera->near_m, far_m = camera->far_m, depth = 1 / (near_m - far_m);

	memset(out, 0, 16 * sizeof(*out));
	out[0] = cosine[quarter] * scale_x;
	out[1] = sine[quarter] * scale_x;
	out[4] = -sine[quarter] * scale_y;
	out[5] = cosine[quarter] * scale_y;
	out[10] = (near_m + far_m) * depth;
	out[11] = -1;
	out[14] = 2 * near_m * far_m * depth;
}

void camera_matrix(const struct camera *camera, float out[16])
{
	float view[16], projection[16];

	camera_view(camera, view);
	camera_projection(camera, projection);
	matrix_multiply(out, projection, view);
}

void camera_ray(const struct camera *camera, float x_px, float y_px, float direction[3])
{
	float right[3], up[3], forward[3];
	float x = 2 * x_px / (float)camera->width_px - 1;
	float y = 1 - 2 * y_px / (float)camera->height_px;

	/* undo the rotation of the projection */
	for (int deg = camera->rotation_deg; deg > 0; deg -= 90) {
		float was_x = x;

		x = y;
		y = -was_x;
	}
	axes_of(camera, right, up, forward);
	vec_scale(direction, x * tangent_of(camera) * camera_aspect(camera), right);
	vec_add_scaled(direction, direction, y * tangent_of(camera), up);
	vec_add(direction, direction, forward);
	/* vec_normalise divides, which rounds otherwise: it would change the bytes of releases. */
	vec_scale(direction, 1 / vec_length(direction), direction);
}

bool camera_pixel(const struct camera *camera, const float point_m[3], float *x_px, float *y_px)
{
	float matrix[16], clip[4];

	camera_matrix(camera, matrix);
	for (int i = 0; i < 4; i++)
		clip[i] = matrix[12 + i] + matrix[8 + i] * point_m[2] + matrix[4 + i] * point_m[1] +
			  matrix[i] * point_m[0];
	if (!(clip[3] > 0))
		return false;
	*x_px = (clip[0] / clip[3] + 1) / 2 * (float)camera->width_px;
	*y_px = (1 - clip[1] / clip[3]) / 2 * (float)camera->height_px;
	return true;
}
