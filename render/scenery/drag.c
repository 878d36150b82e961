/* A finger's ray meets a plane, a line, a cylinder or a sphere through the place that it took; how
 * far that place went is added to the offset. */
#include "render/scenery/drag.h"

#include <string.h>

#include "geometry/turn.h"
#include "geometry/vec.h"

/* A ray along a plane, or shorter than this, has no place on it. */
static const float least = 1e-4f;

void drag_init(struct drag *drag, const struct scenery_drag *of)
{
	*drag = (struct drag){ 0 };
	memcpy(drag->offset, of->offset, sizeof(drag->offset));
	memcpy(drag->value, of->offset, sizeof(drag->value));
}

/* A ray in the handle's metres; its direction has the length 1. */
struct ray {
	float from[3], along[3];
};

static struct ray ray_of(const struct drag *drag, const float from_m[3], const float direction[3])
{
	struct ray ray;

	matrix_place(ray.from, drag->to_handle, from_m);
	matrix_direction(ray.along, drag->to_handle, direction);
	vec_normalise(ray.along);
	return ray;
}

/* Returns a value within limits; there are none where low is above high. */
static float within(float value, float low, float high)
{
	return low <= high ? vec_least(vec_most(value, low), high) : value;
}

/* ---- a plane */

/* Sets at to where a ray meets the plane across an axis through `begin`. */
static bool meet_plane(float at[3], const struct ray *ray, const float begin[3], int axis)
{
	const float along = ray->along[axis];
	const float length = fabsf(along) > least ? (begin[axis] - ray->from[axis]) / along : -1;

	vec_add_scaled(at, ray->from, length, ray->along);
	return length > 0;
}

/* Sets at to the place on the line along an axis through `begin` that is nearest to a ray: what can
 * only slide is held well from wherever it is looked at. */
static bool meet_line(float at[3], const struct ray *ray, const float begin[3], int axis)
{
	const float cosine = ray->along[axis], sine2 = 1 - cosine * cosine;
	float to[3];

	vec_sub(to, ray->from, begin);
	vec_copy(at, begin);
	if (sine2 > least)
		at[axis] += (to[axis] - cosine * vec_dot(to, ray->along)) / sine2;
	return sine2 > least;
}

static void move_in_plane(struct drag *drag, const struct scenery_drag *of, const struct ray *ray)
{
	const bool is_fixed[2] = { of->low[0] == of->high[0], of->low[1] == of->high[1] };
	float at[3];

	if (is_fixed[0] != is_fixed[1] ? !meet_line(at, ray, drag->begin, is_fixed[0] ? 1 : 0)
				       : !meet_plane(at, ray, drag->begin, 2))
		return;
	for (int k = 0; k < 2; k++)
		drag->value[k] =
			within(drag->offset[k] + at[k] - drag->begin[k], of->low[k], of->high[k]);
	drag->value[2] = drag->offset[2];
}

/* ---- a cylinder about y */

/* The turn about y from z towards x. */
static float angle_of(const float at[3])
{
	return atan2f(at[0], at[2]);
}

/* Sets *angle_rad to that of the place of the cylinder that a ray meets, on the side where it was
 * taken. Beyond the edge that is seen, the near side rolls on, and the far side stays. */
static bool meet_cylinder(float *angle_rad, const struct drag *drag, const struct ray *ray)
{
	const float radius = hypotf(drag->begin[0], drag->begin[2]);
	const float length = hypotf(ray->along[0], ray->along[2]);
	float x, z, aside, on;

	if (length < least || radius < least)
		return false;
	x = ray->along[0] / length;
	z = ray->along[2] / length;
	aside = (ray->from[2] * x - ray->from[0] * z) / radius;
	on = within(aside, -1, 1);
	*angle_rad = atan2f(-x, -z); /* of the ray that meets the axis */
	if (on != aside)             /* the ray that just meets the edge */
		*angle_rad = angle_of(ray->from) -
			     asinf(on * radius / hypotf(ray->from[0], ray->from[2]));
	*angle_rad += drag->is_behind ? (float)M_PI - asinf(on) : asinf(on) + aside - on;
	return true;
}

static bool find_angle(float *angle_rad, const struct drag *drag, const struct ray *ray)
{
	float at[3];

	if (!drag->is_disc)
		return meet_cylinder(angle_rad, drag, ray);
	if (!meet_plane(at, ray, drag->begin, 1) || hypotf(at[0], at[2]) < least)
		return false;
	*angle_rad = angle_of(at);
	return true;
}

static void begin_cylinder(struct drag *drag, const struct scenery_drag *of, const struct ray *ray)
{
	drag->is_disc = acosf(vec_least(fabsf(ray->along[1]), 1)) < of->disc_rad;
	drag->is_behind = drag->begin[0] * ray->along[0] + drag->begin[2] * ray->along[2] > 0;
	drag->turned_rad = 0;
	if (!find_angle(&drag->angle_rad, drag, ray))
		drag->angle_rad = angle_of(drag->begin);
}

static void move_on_cylinder(struct drag *drag, const struct scenery_drag *of,
			     const struct ray *ray)
{
	float angle_rad;

	if (!find_angle(&angle_rad, drag, ray))
		return;
	drag->turned_rad += remainderf(angle_rad - drag->angle_rad, 2 * (float)M_PI);
	drag->angle_rad = angle_rad;
	drag->value[0] = within(drag->offset[0] + drag->turned_rad, of->low[0], of->high[0]);
}

/* ---- a sphere */

/* Sets at to where a ray first meets the sphere about the origin. A ray past it meets the edge that
 * is seen, on its side. */
static void meet_sphere(float at[3], const struct ray *ray, float radius)
{
	float off2, half2, eye[3], aside[3], cosine;

	vec_add_scaled(at, ray->from, -vec_dot(ray->from, ray->along), ray->along);
	off2 = vec_dot(at, at);
	half2 = radius * radius - off2;
	if (half2 > 0) {
		vec_add_scaled(at, at, -sqrtf(half2), ray->along);
		return;
	}
	vec_copy(eye, ray->from);
	cosine = radius / vec_normalise(eye);
	vec_add_scaled(aside, at, -vec_dot(at, eye), eye);
	vec_normalise(aside);
	vec_scale(at, radius * cosine, eye);
	vec_add_scaled(at, at, radius * sqrtf(vec_most(1 - cosine * cosine, 0)), aside);
}

/* Sets out to the turn from one direction to another, of length 1. */
static void turn_to(float out[4], const float from[3], const float to[3])
{
	float length;

	vec_cross(out, from, to);
	out[3] = 1 + vec_dot(from, to);
	length = sqrtf(vec_dot(out, out) + out[3] * out[3]);
	if (length < least) { /* opposite: which way is not known */
		const float none[4] = { 0, 0, 0, 1 };

		memcpy(out, none, sizeof(none));
		return;
	}
	for (int k = 0; k < 4; k++)
		out[k] /= length;
}

static void move_on_sphere(struct drag *drag, const struct ray *ray)
{
	const float radius = vec_length(drag->begin);
	float from[3], to[3], turn[4];

	if (radius < least)
		return;
	meet_sphere(to, ray, radius);
	vec_copy(from, drag->begin);
	vec_normalise(from);
	if (vec_normalise(to) < least * radius)
		return;
	turn_to(turn, from, to);
	turn_twice(drag->value, drag->offset, turn);
}

/* ---- any */

bool drag_begin(struct drag *drag, const struct scenery_drag *of, const float handle[16],
		const float point_m[3], const float direction[3])
{
	struct ray ray;

	if (!matrix_invert(drag->to_handle, handle))
		return false;
	matrix_place(drag->begin, drag->to_handle, point_m);
	ray = ray_of(drag, point_m, direction);
	if (of->kind == SCENERY_DRAG_CYLINDER)
		begin_cylinder(drag, of, &ray);
	return true;
}

void drag_move(struct drag *drag, const struct scenery_drag *of, const float from_m[3],
	       const float direction[3])
{
	const struct ray ray = ray_of(drag, from_m, direction);

	switch (of->kind) {
	case SCENERY_DRAG_PLANE:
		move_in_plane(drag, of, &ray);
		break;
	case SCENERY_DRAG_CYLINDER:
		move_on_cylinder(drag, of, &ray);
		break;
	default:
		move_on_sphere(drag, &ray);
		break;
	}
}

void drag_value(const struct drag *drag, const struct scenery_drag *of, float out[4])
{
	static const float up[3] = { 0, 1, 0 };

	if (of->kind == SCENERY_DRAG_CYLINDER)
		turn_about(out, up, drag->value[0]);
	else
		memcpy(out, drag->value, 4 * sizeof(*out));
}

void drag_end(struct drag *drag, const struct scenery_drag *of)
{
	memcpy(drag->offset, of->keeps ? drag->value : of->offset, sizeof(drag->offset));
}
