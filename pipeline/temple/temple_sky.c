/* Marks the voxels that sheets touch, casts rays from free voxels next to them when one is asked
 * for, and interpolates the result. */
#include "pipeline/temple/temple_sky.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

enum { WIDE = 152, HIGH = 92, STATIONS_MAX = 4096, RAYS = 26, REACH = 30 };
static const float voxel_m = 0.3f;
enum { FREE, SOLID, NEAR }; /* near: free, beside solid ones */

struct sky {
	uint8_t kind[HIGH][WIDE][WIDE];
	/* 1..255, for near voxels; 0: not computed yet, or never */
	uint8_t open[HIGH][WIDE][WIDE];
};

static int cell(float metres, float low_m)
{
	return (int)floorf((metres - low_m) / voxel_m);
}

static const float low_m[3] = { -22.8f, -22.8f, -0.9f };

static bool inside(int x, int y, int z)
{
	return x >= 0 && y >= 0 && z >= 0 && x < WIDE && y < WIDE && z < HIGH;
}

/* Marks a quad of a sheet, sampled twice per voxel. */
static void mark_quad(struct sky *sky, const float a[3], const float b[3], const float c[3],
		      const float d[3])
{
	float width = fmaxf(fabsf(b[0] - a[0]) + fabsf(b[1] - a[1]) + fabsf(b[2] - a[2]), 0.01f);
	float height = fmaxf(fabsf(c[0] - a[0]) + fabsf(c[1] - a[1]) + fabsf(c[2] - a[2]), 0.01f);
	int nu = (int)ceilf(width / voxel_m * 2), nv = (int)ceilf(height / voxel_m * 2);

	for (int j = 0; j <= nv; j++) {
		for (int i = 0; i <= nu; i++) {
			float u = (float)i / (float)nu, v = (float)j / (float)nv, p[3];
			for (int k = 0; k < 3; k++)
				p[k] = (a[k] * (1 - u) + b[k] * u) * (1 - v) +
				       (c[k] * (1 - u) + d[k] * u) * v;
			int x = cell(p[0], low_m[0]), y = cell(p[1], low_m[1]),
			    z = cell(p[2], low_m[2]);
			if (inside(x, y, z))
				sky->kind[z][y][x] = SOLID;
		}
	}
}

static void mark_sheet(struct sky *sky, const struct sheet *sheet, struct station *across,
		       struct station *up)
{
	uint32_t columns, rows;

	sheet_stations(sheet, 2.0f, across, &columns, up, &rows, STATIONS_MAX);
	uint32_t quads = sheet_wraps(sheet) ? columns : columns - 1;
	if (columns == 0 || columns > STATIONS_MAX || rows > STATIONS_MAX)
		return;
	for (uint32_t j = 0; j + 1 < rows; j++) {
		for (uint32_t i = 0; i < quads; i++) {
			float p[4][3], hollow;
			for (int k = 0; k < 4; k++)
				sheet_at(sheet, &across[(i + (k & 1)) % columns], &up[j + (k >> 1)],
					 p[k], &hollow);
			mark_quad(sky, p[0], p[1], p[2], p[3]);
		}
	}
}

/* Returns the share of rays from a free voxel that reach the sky; steep rays have more weight. */
static uint8_t look_up(const struct sky *sky, int x, int y, int z)
{
	float seen = 0, all = 0;

	for (int r = 0; r < RAYS; r++) {
		float up = 0.08f + 0.9f * ((float)r + 0.5f) / RAYS, turn = (float)r * 2.39996f;
		float flat = sqrtf(1 - up * up);
		float step[3] = { cosf(turn) * flat, sinf(turn) * flat, up };
		float at[3] = { (float)x + 0.5f, (float)y + 0.5f, (float)z + 0.5f };
		bool free = true;
		for (int n = 0; n < REACH && free; n++) {
			for (int k = 0; k < 3; k++)
				at[k] += step[k];
			int i = (int)at[0], j = (int)at[1], k = (int)at[2];
			if (!inside(i, j, k))
				break;
			free = sky->kind[k][j][i] != SOLID;
		}
		float weight = 0.3f + up;
		seen += free ? weight : 0;
		all += weight;
	}
	return (uint8_t)(1 + 254 * seen / all);
}

/* Marks the free voxels that a vertex in this solid voxel may ask for. */
static void mark_around(struct sky *sky, int x, int y, int z)
{
	for (int k = z - 2; k <= z + 2; k++)
		for (int j = y - 2; j <= y + 2; j++)
			for (int i = x - 2; i <= x + 2; i++)
				if (inside(i, j, k) && sky->kind[k][j][i] == FREE)
					sky->kind[k][j][i] = NEAR;
}

int sky_create(struct sky **out, const struct plan *plan)
{
	struct sky *sky = calloc(1, sizeof(*sky));
	struct station *stations = calloc(2 * STATIONS_MAX, sizeof(*stations));

	*out = NULL;
	if (!sky || !stations) {
		free(sky);
		free(stations);
		return -ENOMEM;
	}
	for (uint32_t i = 0; i < plan->count; i++)
		mark_sheet(sky, &plan->sheets[i], stations, stations + STATIONS_MAX);
	free(stations);
	for (int z = 0; z < HIGH; z++)
		for (int y = 0; y < WIDE; y++)
			for (int x = 0; x < WIDE; x++)
				if (sky->kind[z][y][x] == SOLID)
					mark_around(sky, x, y, z);
	*out = sky;
	return 0;
}

void sky_destroy(struct sky *sky)
{
	free(sky);
}

/* Interpolates between the eight voxels around a point in front of the surface; solid ones do not
 * count. */
float sky_open(struct sky *sky, const float position_m[3], const float normal[3])
{
	float at[3], sum = 0, weights = 0;
	int base[3];

	for (int k = 0; k < 3; k++) {
		at[k] = (position_m[k] + normal[k] * 0.34f - low_m[k]) / voxel_m - 0.5f;
		base[k] = (int)floorf(at[k]);
		at[k] -= (float)base[k];
	}
	for (int c = 0; c < 8; c++) {
		int x = base[0] + (c & 1), y = base[1] + (c >> 1 & 1), z = base[2] + (c >> 2);
		float weight = (c & 1 ? at[0] : 1 - at[0]) * (c & 2 ? at[1] : 1 - at[1]) *
			       (c & 4 ? at[2] : 1 - at[2]);
		if (!inside(x, y, z) || sky->kind[z][y][x] == SOLID)
			continue;
		if (sky->kind[z][y][x] == NEAR && !sky->open[z][y][x])
			sky->open[z][y][x] = look_up(sky, x, y, z);
		sum += weight * (float)sky->open[z][y][x];
		weights += weight;
	}
	return weights > 0.02f ? sum / weights / 255 : 0.25f;
}
