/* Turns counts of feature points into qualities of tiles, and fits them into a budget. */
#include "pipeline/samples/tile_quality.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

/* The common quality is refined in parts of 1 / FINE_STEPS: every tile is rounded on its own, so
 * that few of them change at a time. */
enum { FINE_STEPS = 8, QUALITY_MAX = 100 };

static const uint32_t *counts_at(const struct tile_features *features, uint32_t scale)
{
	return features->counts + (size_t)(scale - 1) * features->tile_count;
}

void tile_quality_set(uint8_t *out, const struct tile_features *features, uint32_t scale,
		      double quality, double deviation)
{
	const uint32_t *counts = counts_at(features, scale);
	uint32_t low = UINT32_MAX, high = 0;
	uint64_t sum = 0;

	for (uint32_t i = 0; i < features->tile_count; i++) {
		low = counts[i] < low ? counts[i] : low;
		high = counts[i] > high ? counts[i] : high;
		sum += counts[i];
	}
	for (uint32_t i = 0; i < features->tile_count; i++) {
		double mean = (double)sum / features->tile_count;
		double share = high > low ? ((double)counts[i] - mean) / (high - low) : 0;
		double value = floor(quality + share * deviation + 0.5);

		out[i] = (uint8_t)(value < 1 ? 1 : value > QUALITY_MAX ? QUALITY_MAX : value);
	}
}

static uint64_t total(const struct tile_budget_options *options, const uint8_t *qualities)
{
	uint64_t bytes = 0;

	for (uint32_t i = 0; i < options->features.tile_count; i++)
		bytes += options->tile_bytes(options->user, i, qualities[i]);
	return bytes;
}

/* Sets qualities, and returns whether they fit. */
static bool try(struct tile_budget_result *out, uint8_t *qualities,
		const struct tile_budget_options *options, uint32_t scale, double quality)
{
	tile_quality_set(qualities, &options->features, scale, quality, options->deviation);
	out->scale = scale;
	out->quality = quality;
	out->total_bytes = total(options, qualities);
	return out->total_bytes <= options->budget_bytes;
}

/* The common quality of a scale: the best for the finest, the worst for the coarsest. */
static double quality_of(const struct tile_budget_options *options, uint32_t scale)
{
	uint32_t count = options->features.scale_count;

	return count == 1 ? options->worst
			  : options->best - (double)(options->best - options->worst) * (scale - 1) /
						    (count - 1);
}

/* Raises the common quality at a scale that fits, up to that of the finer scale. */
static void refine(struct tile_budget_result *out, uint8_t *qualities,
		   const struct tile_budget_options *options, uint32_t scale)
{
	double low = quality_of(options, scale);
	double top = scale > 1 ? quality_of(options, scale - 1) : options->best;
	uint32_t fits = 0, fails = (uint32_t)ceil((top - low) * FINE_STEPS) + 1;

	while (fits + 1 < fails) {
		uint32_t middle = (fits + fails) / 2;

		if (try(out, qualities, options, scale, low + (double)middle / FINE_STEPS))
			fits = middle;
		else
			fails = middle;
	}
	/* did fit, or qualities are those of the last that did not */
	if (!try(out, qualities, options, scale, low + (double)fits / FINE_STEPS))
		out->total_bytes = UINT64_MAX; /* not if tile_bytes keeps its promise */
}

/* A tile and how many feature points it has. */
struct rank {
	uint32_t count, tile;
};

static int by_count(const void *a, const void *b)
{
	const struct rank *x = a, *y = b;

	return x->count != y->count ? (x->count < y->count) - (x->count > y->count)
				    : (x->tile > y->tile) - (x->tile < y->tile);
}

/* Raises single tiles by one as long as they fit. */
static int fill(struct tile_budget_result *out, uint8_t *qualities,
		const struct tile_budget_options *options)
{
	const uint32_t *counts = counts_at(&options->features, out->scale);
	uint32_t tile_count = options->features.tile_count;
	struct rank *ranks = malloc(tile_count * sizeof(*ranks));

	if (!ranks)
		return -ENOMEM;
	for (uint32_t i = 0; i < tile_count; i++)
		ranks[i] = (struct rank){ counts[i], i };
	qsort(ranks, tile_count, sizeof(*ranks), by_count);
	for (uint32_t i = 0; i < tile_count; i++) {
		uint32_t tile = ranks[i].tile;
		uint8_t quality = qualities[tile];
		uint64_t more;

		if (quality >= options->best)
			continue;
		more = options->tile_bytes(options->user, tile, (uint8_t)(quality + 1)) -
		       options->tile_bytes(options->user, tile, quality);
		if (out->total_bytes + more > options->budget_bytes)
			continue;
		qualities[tile]++;
		out->total_bytes += more;
	}
	free(ranks);
	return 0;
}

int tile_budget_meet(struct tile_budget_result *out, uint8_t *qualities,
		     const struct tile_budget_options *options)
{
	const uint32_t count = options->features.scale_count;
	uint32_t scale = 1;

	if (try(out, qualities, options, 1, options->best))
		return 0;
	while (scale < count && !try(out, qualities, options, scale, quality_of(options, scale)))
		scale++;
	if (scale == count && !try(out, qualities, options, count, quality_of(options, count)))
		return -E2BIG;
	refine(out, qualities, options, scale);
	return fill(out, qualities, options);
}
