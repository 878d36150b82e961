/* Vectors of three floats, and 4 x 4 matrices of 16 floats in column-major order. Inline functions,
 * because a call would cost more than the work. The result comes first and may be an operand,
 * except in matrix_multiply. */
#ifndef GOPURA_GEOMETRY_VEC_H
#define GOPURA_GEOMETRY_VEC_H

#include <math.h>
#include <stdbool.h>

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

/* out = a */
static inline void vec_copy(float out[3], const float a[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = a[i];
}

/* out = a - b */
static inline void vec_sub(float out[3], const float a[3], const float b[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = a[i] - b[i];
}

/* out = a + b */
static inline void vec_add(float out[3], const float a[3], const float b[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = a[i] + b[i];
}

/* out = scale * a */
static inline void vec_scale(float out[3], float scale, const float a[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = scale * a[i];
}

/* out = a + scale * b */
static inline void vec_add_scaled(float out[3], const float a[3], float scale, const float b[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = a[i] + scale * b[i];
}

/* out = a + share * (b - a): a where share is 0, b where it is 1. */
static inline void vec_mix(float out[3], const float a[3], const float b[3], float share)
{
	for (int i = 0; i < 3; i++)
		out[i] = a[i] + share * (b[i] - a[i]);
}

/* out = a x b */
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

/* out = a b: what b does, and then what a does. */
static inline void matrix_multiply(float out[16], const float a[16], const float b[16])
{
	for (int column = 0; column < 4; column++) {
		for (int row = 0; row < 4; row++) {
			float sum = 0;
			for (int k = 0; k < 4; k++)
				sum += a[4 * k + row] * b[4 * column + k];
			out[4 * column + row] = sum;
		}
	}
}

/* Sets out to where a matrix whose last row is 0 0 0 1 brings a place; out is not `at`. */
static inline void matrix_place(float out[3], const float m[16], const float at[3])
{
	for (int row = 0; row < 3; row++)
		out[row] = m[row] * at[0] + m[4 + row] * at[1] + m[8 + row] * at[2] + m[12 + row];
}

/* The same for a direction. */
static inline void matrix_direction(float out[3], const float m[16], const float along[3])
{
	for (int row = 0; row < 3; row++)
		out[row] = m[row] * along[0] + m[4 + row] * along[1] + m[8 + row] * along[2];
}

/* Sets out to the cofactors of the upper 3 x 3 part, column by column: normals go by them, whatever
 * the scale. Its determinant is that of the first columns of both: vec_dot(&m[0], &out[0]). */
static inline void matrix_cofactors(float out[9], const float m[16])
{
	vec_cross(&out[0], &m[4], &m[8]);
	vec_cross(&out[3], &m[8], &m[0]);
	vec_cross(&out[6], &m[0], &m[4]);
}

/* Sets out to the inverse of a matrix whose last row is 0 0 0 1. Returns false where it has none;
 * out is then not set. */
static inline bool matrix_invert(float out[16], const float m[16])
{
	float rows[9], det;

	matrix_cofactors(rows, m);
	det = vec_dot(&m[0], &rows[0]);
	if (!(fabsf(det) > 1e-18f))
		return false;
	for (int row = 0; row < 3; row++) {
		for (int k = 0; k < 3; k++)
			out[4 * k + row] = rows[3 * row + k] / det;
		out[12 + row] = -vec_dot(&rows[3 * row], &m[12]) / det;
		out[4 * row + 3] = 0;
	}
	out[15] = 1;
	return true;
}

#endif
