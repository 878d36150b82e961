/* Predicts positions, normals and colours of patch vertices from those already coded, in
 * integers. */
#include "format/predict.h"

static int32_t distance(int32_t a, int32_t b)
{
	return a < b ? b - a : a - b;
}

static int32_t larger(int32_t a, int32_t b)
{
	return a > b ? a : b;
}

static uint32_t bit_length(int32_t number)
{
	return number == 0 ? 0 : 32 - (uint32_t)__builtin_clz((uint32_t)number);
}

/* An axis along which the known vertices differ little, beside the others, is one along which the
 * surface is flat. */
static uint32_t position_model(int32_t extent, int32_t largest)
{
	uint32_t bits = bit_length(extent), less = bit_length(largest) - bits;

	return 2 + 4 * bits + (less < 3 ? less : 3);
}

void predict_position(int32_t out[3], uint32_t models[3], const struct predict_step *step,
		      const struct patch_vertex *vertices, const int32_t most[3])
{
	const int32_t *a = vertices[step->from[0]].position;
	const int32_t *b = vertices[step->from[1]].position;
	const int32_t *c = vertices[step->from[2]].position;
	int32_t extents[3], largest = 0;

	if (step->known_count < 2) {
		for (int i = 0; i < 3; i++) {
			out[i] = step->known_count ? a[i] : 0;
			models[i] = step->known_count;
		}
		return;
	}
	if (step->known_count == 2) {
		for (int i = 0; i < 3; i++) {
			out[i] = (a[i] + b[i]) / 2;
			extents[i] = distance(a[i], b[i]);
		}
	} else {
		for (int i = 0; i < 3; i++) {
			int32_t guess = a[i] + b[i] - c[i];

			out[i] = guess < 0 ? 0 : guess > most[i] ? most[i] : guess;
			extents[i] = larger(distance(a[i], b[i]), distance(a[i], c[i]));
		}
	}
	largest = larger(extents[0], larger(extents[1], extents[2]));
	for (int i = 0; i < 3; i++)
		models[i] = position_model(extents[i], largest);
}

void predict_colour(uint8_t out[4], uint32_t *colour_model, uint32_t *open_model,
		    const struct predict_step *step, const struct patch_vertex *vertices,
		    const uint8_t unknown[4])
{
	const uint8_t *a = step->known_count ? vertices[step->from[0]].colour : unknown;
	const uint8_t *b = step->known_count > 1 ? vertices[step->from[1]].colour : a;
	uint32_t green = bit_length(distance(a[1], b[1])), open = (uint32_t)distance(a[3], b[3]);

	for (int i = 0; i < 4; i++)
		out[i] = (uint8_t)((a[i] + b[i]) / 2);
	*colour_model = green < PREDICT_COLOUR_MODELS ? green : PREDICT_COLOUR_MODELS - 1;
	*open_model = open < PREDICT_OPEN_MODELS ? open : PREDICT_OPEN_MODELS - 1;
}

/* The normal with the length of twice the area; at most 2^49 per axis, and 2^33 where positions
 * have 16 bits. */
static void triangle_cross(int64_t out[3], const int32_t *a, const int32_t *b, const int32_t *c)
{
	int64_t u[3], v[3];

	for (int i = 0; i < 3; i++) {
		u[i] = b[i] - a[i];
		v[i] = c[i] - a[i];
	}
	for (int i = 0; i < 3; i++)
		out[i] = u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
}

static int64_t divide_rounded(int64_t value, int64_t by)
{
	return value >= 0 ? (value + by / 2) / by : -((-value + by / 2) / by);
}

static int64_t magnitude(int64_t value)
{
	return value < 0 ? -value : value;
}

/* 127 times the length must fit in 64 bits; only the sums of large triangles on a large site are
 * halved for it. */
void predict_octahedral(int8_t out[2], const int64_t sum[3])
{
	int64_t n[3] = { sum[0], sum[1], sum[2] }, length, x, y;

	while (magnitude(n[0]) >> 49 || magnitude(n[1]) >> 49 || magnitude(n[2]) >> 49)
		for (int i = 0; i < 3; i++)
			n[i] /= 2;
	length = magnitude(n[0]) + magnitude(n[1]) + magnitude(n[2]);
	if (length == 0) {
		out[0] = out[1] = 0;
		return;
	}
	x = n[0];
	y = n[1];
	if (n[2] < 0) {
		x = (length - magnitude(n[1])) * (n[0] >= 0 ? 1 : -1);
		y = (length - magnitude(n[0])) * (n[1] >= 0 ? 1 : -1);
	}
	out[0] = (int8_t)divide_rounded(127 * x, length);
	out[1] = (int8_t)divide_rounded(127 * y, length);
}

void predict_add_normals(int64_t (*sums)[3], const struct patch_vertex *vertices,
			 const uint32_t *members, const uint16_t *indices, uint32_t triangle_count)
{
	for (uint32_t t = 0; t < triangle_count; t++) {
		uint32_t corners[3];
		int64_t cross[3];

		for (int c = 0; c < 3; c++)
			corners[c] = members[indices[3 * t + (uint32_t)c]];
		triangle_cross(cross, vertices[corners[0]].position, vertices[corners[1]].position,
			       vertices[corners[2]].position);
		for (int c = 0; c < 3; c++)
			for (int i = 0; i < 3; i++)
				sums[corners[c]][i] += cross[i];
	}
}
