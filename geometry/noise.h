/* Value noise for procedural colours, in C and in GLSL: both are the same functions line for line,
 * so a change of one is a change of both. All randomness comes from a permutation polynomial modulo
 * 289, whose intermediate values are integers below 2^24: 32-bit floats represent them exactly, so
 * C and GLSL agree. A quarter, not a half, is added before a floor: above 2^23 floats have no
 * halves. Inline, because loops over many places become vector instructions. */
#ifndef GOPURA_GEOMETRY_NOISE_H
#define GOPURA_GEOMETRY_NOISE_H

#include <math.h>

#include "base/compiler.h"

vector_inline float noise_mod289(float x)
{
	return x - floorf((x + 0.25f) * (1.0f / 289.0f)) * 289.0f;
}

/* Permutes an integer 0..577, the sum of two remainders. */
vector_inline float noise_permute(float x)
{
	return noise_mod289((34.0f * x + 1.0f) * x);
}

/* Returns a random number below 1 of three integers. */
vector_inline float noise_hash(float i, float j, float k)
{
	return noise_permute(noise_permute(noise_permute(noise_mod289(i)) + noise_mod289(j)) +
			     noise_mod289(k)) *
	       (1.0f / 289.0f);
}

vector_inline float noise_blend(float a, float b, float t)
{
	return a + (b - a) * t;
}

vector_inline float noise_at_least(float x, float least)
{
	return x > least ? x : least;
}

vector_inline float noise_at_most(float x, float most)
{
	return x < most ? x : most;
}

/* Rises smoothly from 0 at from to 1 at to; to may be below from. */
vector_inline float noise_ramp(float from, float to, float x)
{
	float t = noise_at_most(noise_at_least((x - from) / (to - from), 0.0f), 1.0f);

	return t * t * (3.0f - 2.0f * t);
}

/* Returns value noise, 0..1, of cells of side 1; places up to 2^16 in size. */
vector_inline float noise_at(float x, float y, float z)
{
	float i = floorf(x), j = floorf(y), k = floorf(z);
	float u = x - i, v = y - j, w = z - k;

	u = u * u * (3.0f - 2.0f * u);
	v = v * v * (3.0f - 2.0f * v);
	w = w * w * (3.0f - 2.0f * w);
	float a = noise_permute(noise_mod289(i)), b = noise_permute(noise_mod289(i + 1.0f));
	float m = noise_mod289(j), n = noise_mod289(j + 1.0f);
	float aa = noise_permute(a + m), ba = noise_permute(b + m), ab = noise_permute(a + n),
	      bb = noise_permute(b + n);
	float lo = noise_mod289(k), hi = noise_mod289(k + 1.0f);
	float low = noise_blend(noise_blend(noise_permute(aa + lo), noise_permute(ba + lo), u),
				noise_blend(noise_permute(ab + lo), noise_permute(bb + lo), u), v);
	float high = noise_blend(noise_blend(noise_permute(aa + hi), noise_permute(ba + hi), u),
				 noise_blend(noise_permute(ab + hi), noise_permute(bb + hi), u), v);

	return noise_blend(low, high, w) * (1.0f / 288.0f);
}

/* Returns value noise, 0..1, with cells of 1 / (fx, fy, fz) metres. */
vector_inline float noise_value(const float p[3], float fx, float fy, float fz)
{
	return noise_at(p[0] * fx, p[1] * fy, p[2] * fz);
}

/* Returns the share of detail of size 1 / frequency that is kept; it falls as the footprint
 * grows. */
vector_inline float noise_kept(float frequency, float footprint_m)
{
	return noise_at_most(noise_at_least(1.6f - 1.6f * frequency * footprint_m, 0.0f), 1.0f);
}

/* GLSL ES 1.00 source of the same functions; noise_value takes a vec3, and min and max stand for
 * noise_at_most and noise_at_least. It needs "precision highp float" where it is included. */
extern const char noise_glsl[];

#endif
