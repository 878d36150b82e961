/* Vectors of three floats. Inline functions, because a call would cost more than the work. */
#ifndef GOPURA_GEOMETRY_VEC_H
#define GOPURA_GEOMETRY_VEC_H

#include <math.h>

/* Minimum and maximum of two numbers. fminf and fmaxf become library calls because they must handle
 * NaN; nothing here is NaN. */
static inline float vec_least(float a, float b)
{
	return a < b ? a : b;
}

/* The larger of two numbers. */
static inline float vec_most(float a, float b)
{
	return a > b ? a : b;
}

/* Returns the dot product. */
static inline float vec_dot(const float a[3], const float b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* out = a - b */
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

/* out = a x b; out may be a or b. */
static inline void vec_cross(float out[3], const float a[3], const float b[3])
{
	float x = a[1] * b[2] - a[2] * b[1];
	float y = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
	out[0] = x;
	out[1] = y;
}

/* Returns the Euclidean length. */
static inline float vec_length(const float a[3])
{
	return sqrtf(vec_dot(a, a));
}

/* Returns the distance between two points. */
static inline float vec_distance(const float a[3], const float b[3])
{
	float d[3];
	vec_sub(d, a, b);
	return vec_length(d);
}

/* Scales a to unit length and returns the length it had. A zero vector stays zero. */
static inline float vec_normalise(float a[3])
{
	float length = vec_length(a);
	for (int i = 0; i < 3 && length > 0; i++)
		a[i] /= length;
	return length;
}

#endif
