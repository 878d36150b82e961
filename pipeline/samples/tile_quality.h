/* The quality of every tile by its feature points, and the loop that makes all tiles fit a number
 * of bytes, after Cheng and Boulanger, "Scale-Space 3D TexMesh Simplification" (paper P2),
 * sections 2 and 3. Results depend on the numbers alone, not on who computed them in what order. */
#ifndef GOPURA_PIPELINE_SAMPLES_TILE_QUALITY_H
#define GOPURA_PIPELINE_SAMPLES_TILE_QUALITY_H

#include <stdint.h>

#include "base/compiler.h"

/* Feature points of each tile, scale by scale: counts[(scale - 1) * tile_count + tile] of those
 * that survive at least to the scale. */
struct tile_features {
	uint32_t tile_count, scale_count; /* at least 1 */
	const uint32_t *counts;           /* borrowed */
};

/* Sets the quality of each tile at a scale (1 .. scale_count):
 *   quality + (n - mean of all n) * deviation, rounded and limited to 1..100,
 * where n is its count of feature points as a share of the way from the lowest to the highest count
 * of a tile. If all counts are equal, all tiles have `quality`. out: tile_count numbers. */
void tile_quality_set(uint8_t *out, const struct tile_features *features, uint32_t scale,
		      double quality, double deviation);

struct tile_budget_options {
	struct tile_features features;
	double deviation;    /* 0: all tiles alike */
	uint8_t best, worst; /* of the common quality, 1..100; best is not below worst */
	uint64_t budget_bytes;
	/* Returns the bytes of a tile at a quality of 1..100; more or as many at a higher one. */
	uint32_t (*tile_bytes)(void *user, uint32_t tile, uint8_t quality);
	void *user;
};

struct tile_budget_result {
	uint32_t scale;
	double quality;       /* the common one */
	uint64_t total_bytes; /* of all tiles; the least possible after -E2BIG */
};

/* Goes from the finest scale and the best quality to the coarsest scale and the worst quality until
 * the tiles fit, then raises the quality in that step as far as it fits, and at last that of single
 * tiles by one, those with the most feature points first. qualities: tile_count numbers. Returns
 * -E2BIG if not even the worst fits: *out and qualities are then of that; or -ENOMEM. */
must_check int tile_budget_meet(struct tile_budget_result *out, uint8_t *qualities,
				const struct tile_budget_options *options);

#endif
