/* Predicts the normals of patch vertices from positions and triangles, in integers. */
#include "format/predict.h"

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

/* Thousands of triangles that are as large as a large site may meet at a vertex: the sum wraps
 * around, which both directions do alike. */
static void add_cross(int64_t sum[3], const int64_t cross[3])
{
	for (int i = 0; i < 3; i++)
		sum[i] = (int64_t)((uint64_t)sum[i] + (uint64_t)cross[i]);
}

static int64_t divide_rounded(int64_t value, int64_t by)
{
	return value >= 0 ? (value + by / 2) / by : -((-value + by / 2) / by);
}

static int64_t magnitude(int64_t value)
{
	return value < 0 ? -(value + (value == INT64_MIN)) : value;
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

void predict_add_cross(int64_t sum[3], const int32_t *a, const int32_t *b, const int32_t *c)
{
	int64_t cross[3];

	triangle_cross(cross, a, b, c);
	add_cross(sum, cross);
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
			add_cross(sums[corners[c]], cross);
	}
}
