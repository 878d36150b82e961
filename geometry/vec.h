/* Three floats. Small enough that a call would cost more than the work. */
#ifndef GOPURA_GEOMETRY_VEC_H
#define GOPURA_GEOMETRY_VEC_H

#include <math.h>

/* fminf and fmaxf are calls where NaN must be minded; nothing here is NaN. */
static inline float vec_least(float a, float b)
{
	return a < b ? a : b;
}

static inline float vec_most(float a, float b)
{
	return a > b ? a : b;
}

static inline float vec_dot(const float a[3], const float b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void vec_sub(float out[3], const float a[3], const float b[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = a[i] - b[i];
}

/* out = a + scale * b */
static inline void vec_add_scaled(float out[3], const float a[3], float scale, const float b[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = a[i] + scale * b[i];
}

static inline void vec_cross(float out[3], const float a[3], const float b[3])
{
	float x = a[1] * b[2] - a[2] * b[1];
	float y = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
	out[0] = x;
	out[1] = y;
}

static inline float vec_length(const float a[3])
{
	return sqrtf(vec_dot(a, a));
}

static inline float vec_distance(const float a[3], const float b[3])
{
	float d[3];
	vec_sub(d, a, b);
	return vec_length(d);
}

/* Returns the length it had; a zero vector stays zero. */
static inline float vec_normalise(float a[3])
{
	float length = vec_length(a);
	for (int i = 0; i < 3 && length > 0; i++)
		a[i] /= length;
	return length;
}

#endif
