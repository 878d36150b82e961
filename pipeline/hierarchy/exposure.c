/* Estimates the visibility of vertices: converts the scan to voxels and casts rays through them
 * from the air in front of the surface to a few viewpoints. */
#include "pipeline/hierarchy/exposure.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "base/shared_memory.h"

enum {
	SIDE = 256, /* voxels along the longest axis */
	BRICK = 4,  /* a brick of so many voxels a side is one word of 64 bits, x fastest */
	BRICKS = SIDE / BRICK,
	MARGIN = 2,     /* voxels of air at the sides and above, where rays may start */
	VIEWPOINTS = 8, /* of a voxel; neighbours have others, so a patch has many */
	KNOWN = 1 << VIEWPOINTS
};

/* Distance in front of the surface at which rays start: outside the voxels that it fills itself. */
#define START_VOXELS 1.5f

struct exposure {
	uint64_t solid[BRICKS * BRICKS * BRICKS]; /* material, or enclosed by it */
	/* For each voxel, once it is KNOWN: a bit for each viewpoint that it is seen from. */
	uint16_t seen_from[SIDE * SIDE * SIDE];
	float low[3], high[3]; /* bounding box of the model, in voxels */
};

/* The model keeps away from the sides and the top of the grid. It stands on its floor, because no
 * camera is below. */
static float to_voxels(uint16_t position, int axis)
{
	const float scale = (float)(SIDE - 2 * MARGIN) / 65536.0f;

	return (float)position * scale + (axis < 2 ? MARGIN : 0);
}

static uint32_t brick_of(const int voxel[3])
{
	return (uint32_t)((voxel[2] / BRICK * BRICKS + voxel[1] / BRICK) * BRICKS +
			  voxel[0] / BRICK);
}

static uint64_t bit_in_brick(const int voxel[3])
{
	return UINT64_C(1) << ((voxel[2] % BRICK * BRICK + voxel[1] % BRICK) * BRICK +
			       voxel[0] % BRICK);
}

static bool is_solid(const struct exposure *exposure, const int voxel[3])
{
	return exposure->solid[brick_of(voxel)] & bit_in_brick(voxel);
}

static int clamp_voxel(float at)
{
	return at < 0.0f ? 0 : at >= (float)SIDE ? SIDE - 1 : (int)at;
}

int exposure_create(struct exposure **out)
{
	*out = shared_memory_create(sizeof(**out));
	return *out ? 0 : -ENOMEM;
}

void exposure_destroy(struct exposure *exposure)
{
	shared_memory_destroy(exposure, sizeof(*exposure));
}

/* Marks the voxels of sample points on the triangle, at most half a voxel apart. */
void exposure_add(struct exposure *exposure, const uint16_t corners[3][3])
{
	float at[3][3], longest = 0;
	uint32_t parts;

	for (int c = 0; c < 3; c++)
		for (int k = 0; k < 3; k++)
			at[c][k] = to_voxels(corners[c][k], k);
	for (int c = 0; c < 3; c++)
		for (int k = 0; k < 3; k++)
			longest = fmaxf(longest, fabsf(at[c][k] - at[(c + 1) % 3][k]));
	parts = 1 + (uint32_t)(2 * longest);
	for (uint32_t u = 0; u <= parts; u++)
		for (uint32_t v = 0; u + v <= parts; v++) {
			float a = (float)u / (float)parts, b = (float)v / (float)parts;
			uint64_t bit, *brick;
			int voxel[3];

			for (int k = 0; k < 3; k++)
				voxel[k] = clamp_voxel(at[0][k] + a * (at[1][k] - at[0][k]) +
						       b * (at[2][k] - at[0][k]));
			bit = bit_in_brick(voxel);
			brick = &exposure->solid[brick_of(voxel)];
			/* Mostly it is marked already. */
			if (!(__atomic_load_n(brick, __ATOMIC_RELAXED) & bit))
				__atomic_fetch_or(brick, bit, __ATOMIC_RELAXED);
		}
}

/* ---- enclosed air */

/* The voxels of a brick at one of its faces: the first or last along an axis. */
static const uint64_t first_of[3] = { 0x1111111111111111, 0x000f000f000f000f, 0x000000000000ffff };
static const uint64_t last_of[3] = { 0x8888888888888888, 0xf000f000f000f000, 0xffff000000000000 };
static const int stride[3] = { 1, BRICK, BRICK *BRICK };          /* bits within a brick */
static const int brick_stride[3] = { 1, BRICKS, BRICKS *BRICKS }; /* bricks */

/* Bricks whose air has been reached from further voxels since they were looked at. */
struct flood {
	const uint64_t *solid;
	uint64_t *reached;
	uint32_t *queue, first, count; /* a ring; each brick is in it once at most */
	bool *queued;
};

enum { BRICK_COUNT = BRICKS * BRICKS * BRICKS };

static void reach(struct flood *flood, uint32_t brick, uint64_t voxels)
{
	voxels &= ~flood->solid[brick] & ~flood->reached[brick];
	if (!voxels)
		return;
	flood->reached[brick] |= voxels;
	if (flood->queued[brick])
		return;
	flood->queued[brick] = true;
	flood->queue[(flood->first + flood->count++) % BRICK_COUNT] = brick;
}

static void reach_sides_and_top(struct flood *flood)
{
	for (uint32_t i = 0; i < BRICKS; i++)
		for (uint32_t j = 0; j < BRICKS; j++) {
			const uint32_t last = BRICKS - 1, row = BRICKS, layer = BRICKS * BRICKS;

			reach(flood, i * layer + j * row, first_of[0]);
			reach(flood, i * layer + j * row + last, last_of[0]);
			reach(flood, i * layer + j, first_of[1]);
			reach(flood, i * layer + last * row + j, last_of[1]);
			reach(flood, last * layer + i * row + j, last_of[2]);
		}
}

/* Spreads within a brick, then to its neighbours. */
static void spread(struct flood *flood, uint32_t brick)
{
	const uint32_t at[3] = { brick % BRICKS, brick / BRICKS % BRICKS,
				 brick / (BRICKS * BRICKS) };
	uint64_t air = ~flood->solid[brick], reached = flood->reached[brick], before;

	do {
		before = reached;
		for (int k = 0; k < 3; k++)
			reached |= ((reached & ~last_of[k]) << stride[k] |
				    (reached & ~first_of[k]) >> stride[k]) &
				   air;
	} while (reached != before);
	flood->reached[brick] = reached;
	for (int k = 0; k < 3; k++) {
		int across = (BRICK - 1) * stride[k];

		if (at[k] > 0)
			reach(flood, brick - (uint32_t)brick_stride[k],
			      (reached & first_of[k]) << across);
		if (at[k] < BRICKS - 1)
			reach(flood, brick + (uint32_t)brick_stride[k],
			      (reached & last_of[k]) >> across);
	}
}

/* Marks enclosed air as solid: no camera gets there. Examples are hollow towers and statues that
 * are open below. */
static int close_hollows(struct exposure *exposure)
{
	struct flood flood = {
		.solid = exposure->solid,
		.reached = calloc(BRICK_COUNT, sizeof(*flood.reached)),
		.queue = calloc(BRICK_COUNT, sizeof(*flood.queue)),
		.queued = calloc(BRICK_COUNT, sizeof(*flood.queued)),
	};
	int rc = flood.reached && flood.queue && flood.queued ? 0 : -ENOMEM;

	if (rc == 0)
		reach_sides_and_top(&flood);
	while (rc == 0 && flood.count > 0) {
		uint32_t brick = flood.queue[flood.first];

		flood.first = (flood.first + 1) % BRICK_COUNT;
		flood.count--;
		flood.queued[brick] = false;
		spread(&flood, brick);
	}
	for (uint32_t i = 0; rc == 0 && i < BRICK_COUNT; i++)
		exposure->solid[i] = ~flood.reached[i];
	free(flood.reached);
	free(flood.queue);
	free(flood.queued);
	return rc;
}

static void find_box(struct exposure *exposure)
{
	for (int k = 0; k < 3; k++) {
		exposure->low[k] = SIDE;
		exposure->high[k] = 0;
	}
	for (uint32_t i = 0; i < BRICK_COUNT; i++) {
		const uint32_t at[3] = { i % BRICKS, i / BRICKS % BRICKS, i / (BRICKS * BRICKS) };

		if (!exposure->solid[i])
			continue;
		for (int k = 0; k < 3; k++) {
			exposure->low[k] = fminf(exposure->low[k], (float)(at[k] * BRICK));
			exposure->high[k] = fmaxf(exposure->high[k], (float)(at[k] + 1) * BRICK);
		}
	}
}

int exposure_close(struct exposure *exposure)
{
	find_box(exposure);
	return close_hollows(exposure);
}

/* ---- rays */

/* A walk over cells of one size along a ray (Amanatides and Woo 1987). Parameters along the ray run
 * from 0 to 1. */
struct walk {
	int at[3], step[3];
	float next[3], each[3]; /* where the next cell of each axis begins, and how far apart */
};

static void walk_start(struct walk *walk, const float from[3], const float along[3], float size)
{
	for (int k = 0; k < 3; k++) {
		float edge = (float)(walk->at[k] + (along[k] > 0.0f)) * size;

		walk->step[k] = along[k] < 0.0f ? -1 : 1;
		walk->each[k] = along[k] == 0.0f ? INFINITY : size / fabsf(along[k]);
		walk->next[k] = along[k] == 0.0f ? INFINITY : (edge - from[k]) / along[k];
	}
}

static int walk_axis(const struct walk *walk)
{
	const float *next = walk->next;

	return next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : next[1] < next[2] ? 1 : 2;
}

/* Walks the voxels of one brick that is not empty. enter is where the ray comes in. */
static bool brick_is_free(uint64_t solid, const int brick[3], const float from[3],
			  const float along[3], float enter)
{
	struct walk walk;

	for (int k = 0; k < 3; k++) {
		int inside = (int)floorf(from[k] + enter * along[k]) - BRICK * brick[k];

		walk.at[k] = BRICK * brick[k] + (inside < 0        ? 0
						 : inside >= BRICK ? BRICK - 1
								   : inside);
	}
	walk_start(&walk, from, along, 1.0f);
	for (;;) {
		int k = walk_axis(&walk);

		if (solid & bit_in_brick(walk.at))
			return false;
		if (!(walk.next[k] < 1.0f))
			return true;
		walk.at[k] += walk.step[k];
		if (walk.at[k] < BRICK * brick[k] || walk.at[k] >= BRICK * (brick[k] + 1))
			return true;
		walk.next[k] += walk.each[k];
	}
}

/* Returns true if no solid voxel lies between two points; from is in the grid. */
static bool is_free(const struct exposure *exposure, const float from[3], const float to[3])
{
	float along[3] = { to[0] - from[0], to[1] - from[1], to[2] - from[2] }, enter = 0.0f;
	struct walk walk;

	for (int k = 0; k < 3; k++)
		walk.at[k] = (int)from[k] / BRICK;
	walk_start(&walk, from, along, BRICK);
	for (;;) {
		const int *at = walk.at;
		uint64_t solid = exposure->solid[(at[2] * BRICKS + at[1]) * BRICKS + at[0]];
		int k = walk_axis(&walk);

		if (solid && !brick_is_free(solid, at, from, along, enter))
			return false;
		enter = walk.next[k];
		walk.at[k] += walk.step[k];
		if (!(enter < 1.0f) || walk.at[k] < 0 || walk.at[k] >= BRICKS)
			return true;
		walk.next[k] += walk.each[k];
	}
}

/* Sets out[k][n] to coordinate k of the n-th viewpoint of a voxel, in the box of twice the model's
 * size above its lowest point. It is a low-discrepancy sequence: multiples of powers of a root of
 * x^4 = x + 1, as the golden ratio is used in one dimension. It starts elsewhere for each voxel. */
static void viewpoints(float out[3][VIEWPOINTS], const struct exposure *exposure, uint32_t voxel)
{
	static const uint32_t steps[3] = { 3518319155u, 2882110345u, 2360945575u }; /* of 2^32 */
	static const uint32_t starts[3] = { 2654435761u, 2246822519u, 3266489917u };

	for (int k = 0; k < 3; k++) {
		float low = exposure->low[k], half = (exposure->high[k] - low) / 2;
		float begin = k == 2 ? low : low - half, wide = k == 2 ? 3 : 4;
		uint32_t at = (voxel + 1) * starts[k];

		for (uint32_t n = 0; n < VIEWPOINTS; n++) {
			/* Signed, because vectors are converted from that. */
			float t = (float)(int32_t)((at + steps[k] * n) >> 8) / 16777216.0f;

			out[k][n] = begin + t * wide * half;
		}
	}
}

/* Two processes may find the same voxel at the same time. Both find the same. */
static uint32_t seen_from(struct exposure *exposure, uint32_t voxel, const int at[3])
{
	uint16_t *place = &exposure->seen_from[voxel];
	uint32_t seen = __atomic_load_n(place, __ATOMIC_RELAXED);
	float eyes[3][VIEWPOINTS];

	if (seen & KNOWN)
		return seen;
	viewpoints(eyes, exposure, voxel);
	for (uint32_t n = 0; n < VIEWPOINTS && !is_solid(exposure, at); n++) {
		const float from[3] = { (float)at[0] + 0.5f, (float)at[1] + 0.5f,
					(float)at[2] + 0.5f };
		const float eye[3] = { eyes[0][n], eyes[1][n], eyes[2][n] };

		seen |= is_free(exposure, from, eye) ? 1u << n : 0;
	}
	__atomic_store_n(place, (uint16_t)(seen | KNOWN), __ATOMIC_RELAXED);
	return seen;
}

/* The cosine of the direction of each viewpoint with the normal. */
static void shares_of(float out[VIEWPOINTS], const float eyes[3][VIEWPOINTS], const float at[3],
		      const float normal[3])
{
	for (int n = 0; n < VIEWPOINTS; n++) {
		float x = eyes[0][n] - at[0], y = eyes[1][n] - at[1], z = eyes[2][n] - at[2];
		float square = x * x + y * y + z * z;
		float cosine = x * normal[0] + y * normal[1] + z * normal[2];

		out[n] = cosine / sqrtf(square);
	}
}

uint8_t exposure_of(struct exposure *exposure, const uint16_t position[3], const float normal[3])
{
	float at[3], seen = 0;

	for (int k = 0; k < 3; k++)
		at[k] = to_voxels(position[k], k);
	for (int side = -1; side < 2; side += 2) {
		float eyes[3][VIEWPOINTS], shares[VIEWPOINTS];
		uint32_t voxel, from;
		int start[3];

		for (int k = 0; k < 3; k++)
			start[k] = clamp_voxel(at[k] + (float)side * START_VOXELS * normal[k]);
		voxel = (uint32_t)((start[2] * SIDE + start[1]) * SIDE + start[0]);
		from = seen_from(exposure, voxel, start) % KNOWN;
		if (!from)
			continue;
		viewpoints(eyes, exposure, voxel);
		shares_of(shares, (const float(*)[VIEWPOINTS])eyes, at, normal);
		/* The other side has viewpoints of its own. Where one is in the vertex itself its
		 * share is no number, and not above 0. */
		for (; from; from &= from - 1) {
			float share = shares[__builtin_ctz(from)];

			if (share * (float)side > 0)
				seen += fabsf(share);
		}
	}
	return (uint8_t)(255 * fminf(1, 2 * seen / VIEWPOINTS) + 0.5f);
}
