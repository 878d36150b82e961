/* Adaptive solid texturing (paper 003, section 4.3): colours of a substance are computed when they
 * are first asked for, and kept in cubes of voxels around the model. A cube has 2^level voxels a
 * side, level n' to n; the footprint of a pixel says which level it reads (lambda = log2 rho). Of a
 * cube only those cells of 2^n' a side are kept, in a hash table, in which a voxel was asked for:
 * the upper bits of a voxel's place name its cell (global index), the lower n' its place in it
 * (local index). When the cells fill the budget, all are forgotten. One thread.
 *
 * The product computes substances on the fly, which is faster there; docs/substance.md has the
 * figures. */
#ifndef GOPURA_TESTS_BENCH_CACHE_CUBE_H
#define GOPURA_TESTS_BENCH_CACHE_CUBE_H

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/compiler.h"
#include "base/map.h"
#include "geometry/substance.h"

enum { CACHE_CUBE_CELL_BITS = 3, CACHE_CUBE_LEVEL_MAX = 22 };

struct cache_cube_options {
	enum substance_kind kind; /* not SUBSTANCE_NONE */
	float low_m[3];           /* corner of the cubes */
	float side_m;             /* above 0; beyond the cubes, nothing is kept */
	/* the coarsest and the finest cube: CACHE_CUBE_CELL_BITS to CACHE_CUBE_LEVEL_MAX; equal:
	 * a single cube */
	uint32_t level_least, level_most;
	uint64_t budget_bytes; /* of cells; at least one is kept */
	/* reads the voxel that a place lies in, as the paper does, not a mean of the eight around
	 * it and of two levels */
	bool nearest;
};

struct cache_cube_counts {
	uint64_t cells, cell_bytes; /* that are kept now */
	uint64_t computed;          /* voxels, altogether */
	uint64_t forgotten;         /* how often all cells were */
};

enum {
	CACHE_CELL_SIDE = 1 << CACHE_CUBE_CELL_BITS,
	CACHE_CELL_VOXELS = CACHE_CELL_SIDE * CACHE_CELL_SIDE * CACHE_CELL_SIDE,
	CACHE_RECENT = 64, /* cells that are found without the table; a power of two */
};

/* 8 bits each of red, green, blue and, as the paper has it, whether the voxel is known. */
struct cache_cell {
	uint32_t voxels[CACHE_CELL_VOXELS];
};

struct cache_recent {
	uint64_t key;
	struct cache_cell *cell; /* borrowed; NULL: none */
};

struct cache_cube {
	struct cache_cube_options options;
	struct map cells; /* from keys to cells, which are owned */
	struct cache_recent recent[CACHE_RECENT];
	struct cache_cube_counts counts;
};

/* *out is owned by the caller; NULL on failure. -ENOMEM. */
must_check static inline int cache_cube_create(struct cache_cube **out,
					       const struct cache_cube_options *options)
{
	*out = calloc(1, sizeof(**out));
	if (!*out)
		return -ENOMEM;
	(*out)->options = *options;
	return 0;
}

static inline void forget_cells(struct cache_cube *cache)
{
	struct cache_cell *cell;
	size_t at = 0;

	while ((cell = map_next_pointer(&cache->cells, &at)))
		free(cell);
	map_clear(&cache->cells);
	memset(cache->recent, 0, sizeof(cache->recent));
	cache->counts.cells = cache->counts.cell_bytes = 0;
}

/* NULL is fine. */
static inline void cache_cube_destroy(struct cache_cube *cache)
{
	if (!cache)
		return;
	forget_cells(cache);
	map_finish(&cache->cells);
	free(cache);
}

static inline struct cache_cube_counts cache_cube_counts(const struct cache_cube *cache)
{
	return cache->counts;
}

/* ---- cells */

static inline struct cache_cell *add_cell(struct cache_cube *cache, uint64_t key)
{
	struct cache_cell *cell;

	if (cache->counts.cells > 0 &&
	    cache->counts.cell_bytes + sizeof(*cell) > cache->options.budget_bytes) {
		forget_cells(cache);
		cache->counts.forgotten++;
	}
	cell = calloc(1, sizeof(*cell));
	if (!cell || map_set(&cache->cells, key, (uint64_t)(uintptr_t)cell) < 0) {
		free(cell);
		return NULL;
	}
	cache->counts.cells++;
	cache->counts.cell_bytes += sizeof(*cell);
	return cell;
}

/* The global index: level, and the cell's place in its cube. */
static inline struct cache_cell *find_cell(struct cache_cube *cache, uint32_t level,
					   const uint32_t voxel[3])
{
	const uint32_t x = voxel[0] >> CACHE_CUBE_CELL_BITS, y = voxel[1] >> CACHE_CUBE_CELL_BITS,
		       z = voxel[2] >> CACHE_CUBE_CELL_BITS;
	const uint64_t key = (uint64_t)level << 58 | (uint64_t)x << 38 | (uint64_t)y << 19 | z;
	struct cache_recent *recent =
		&cache->recent[(x + 5 * y + 17 * z + 31 * level) & (CACHE_RECENT - 1)];
	struct cache_cell *cell;

	if (recent->cell && recent->key == key)
		return recent->cell;
	cell = map_get_pointer(&cache->cells, key);
	if (!cell)
		cell = add_cell(cache, key);
	*recent = (struct cache_recent){ key, cell };
	return cell;
}

/* ---- voxels */

static inline float voxel_side(const struct cache_cube *cache, uint32_t level)
{
	return ldexpf(cache->options.side_m, -(int)level);
}

/* A voxel of a single cube is as large as a pixel; of several, half as large, so that means of
 * eight show what the function does. */
static inline uint32_t voxels_of_footprint(const struct cache_cube *cache)
{
	return cache->options.nearest ? 1 : 2;
}

static inline uint32_t compute_voxel(struct cache_cube *cache, uint32_t level,
				     const uint32_t voxel[3])
{
	const float side = voxel_side(cache, level);
	uint32_t packed = 255u << 24;
	float at[3], rgb[3];

	for (int k = 0; k < 3; k++)
		at[k] = cache->options.low_m[k] + ((float)voxel[k] + 0.5f) * side;
	substance_colour(rgb, cache->options.kind, at, side * (float)voxels_of_footprint(cache));
	for (int k = 0; k < 3; k++)
		packed |= (uint32_t)(fminf(fmaxf(rgb[k], 0), 1) * 255 + 0.5f) << 8 * k;
	cache->counts.computed++;
	return packed;
}

static inline uint32_t read_voxel(struct cache_cube *cache, uint32_t level, const uint32_t voxel[3])
{
	struct cache_cell *cell = find_cell(cache, level, voxel);
	const uint32_t mask = CACHE_CELL_SIDE - 1;
	uint32_t *kept;

	if (!cell)
		return compute_voxel(cache, level, voxel);
	kept = &cell->voxels[((voxel[2] & mask) << 2 * CACHE_CUBE_CELL_BITS) |
			     ((voxel[1] & mask) << CACHE_CUBE_CELL_BITS) | (voxel[0] & mask)];
	if (*kept == 0)
		*kept = compute_voxel(cache, level, voxel);
	return *kept;
}

/* Adds a level's colour times weight. unit: the place in the cube, 0 to 1. */
static inline void add_nearest(struct cache_cube *cache, float rgb[3], const float unit[3],
			       uint32_t level, float weight)
{
	const float count = (float)(1u << level);
	uint32_t voxel[3], packed;

	for (int k = 0; k < 3; k++)
		voxel[k] = (uint32_t)fminf(unit[k] * count, count - 1);
	packed = read_voxel(cache, level, voxel);
	for (int k = 0; k < 3; k++)
		rgb[k] += weight * (float)(packed >> 8 * k & 255) * (1 / 255.0f);
}

static inline void add_mean(struct cache_cube *cache, float rgb[3], const float unit[3],
			    uint32_t level, float weight)
{
	const float last = (float)(1u << level) - 1;
	uint32_t low[3];
	float share[3];

	for (int k = 0; k < 3; k++) {
		const float at = fminf(fmaxf(unit[k] * (last + 1) - 0.5f, 0), last);

		low[k] = (uint32_t)fminf(at, last - 1);
		share[k] = at - (float)low[k];
	}
	for (uint32_t corner = 0; corner < 8; corner++) {
		const uint32_t voxel[3] = { low[0] + (corner & 1), low[1] + (corner >> 1 & 1),
					    low[2] + (corner >> 2) };
		const uint32_t packed = read_voxel(cache, level, voxel);
		const float w = weight * (corner & 1 ? share[0] : 1 - share[0]) *
				(corner & 2 ? share[1] : 1 - share[1]) *
				(corner & 4 ? share[2] : 1 - share[2]);

		for (int k = 0; k < 3; k++)
			rgb[k] += w * (float)(packed >> 8 * k & 255) * (1 / 255.0f);
	}
}

/* Reads a colour, as substance_colour gives it. Without memory for a cell, it is computed and not
 * kept.
 */
static inline void cache_cube_colour(struct cache_cube *cache, float rgb[3],
				     const float position_m[3], float footprint_m)
{
	const struct cache_cube_options *o = &cache->options;
	const float least = (float)o->level_least, most = (float)o->level_most;
	float unit[3], lambda, level, share;

	for (int k = 0; k < 3; k++) {
		unit[k] = (position_m[k] - o->low_m[k]) / o->side_m;
		if (!(unit[k] >= 0 && unit[k] <= 1)) {
			substance_colour(rgb, o->kind, position_m, footprint_m);
			return;
		}
		rgb[k] = 0;
	}
	lambda = most;
	if (footprint_m > 0)
		lambda = log2f(o->side_m * (float)voxels_of_footprint(cache) / footprint_m);
	lambda = fminf(fmaxf(lambda, least), most);
	if (o->nearest) {
		add_nearest(cache, rgb, unit, (uint32_t)ceilf(lambda), 1);
		return;
	}
	level = fminf(floorf(lambda), fmaxf(most - 1, least));
	/* The footprint, not its logarithm, says how much of a detail is kept. */
	share = 2 - exp2f(1 - (lambda - level));
	if (share < 1)
		add_mean(cache, rgb, unit, (uint32_t)level, 1 - share);
	if (share > 0)
		add_mean(cache, rgb, unit, (uint32_t)level + 1, share);
}

/* Computes all voxels of a single cube, which is what this cache makes needless; for comparison.
 * -ENOMEM, also if the budget is too small. */
must_check static inline int cache_cube_fill(struct cache_cube *cache)
{
	const uint32_t level = cache->options.level_most, count = 1u << level;
	uint32_t voxel[3];

	for (voxel[2] = 0; voxel[2] < count; voxel[2]++)
		for (voxel[1] = 0; voxel[1] < count; voxel[1]++)
			for (voxel[0] = 0; voxel[0] < count; voxel[0]++)
				read_voxel(cache, level, voxel);
	return cache->counts.cells << 3 * CACHE_CUBE_CELL_BITS == 1ull << 3 * level ? 0 : -ENOMEM;
}

#endif
