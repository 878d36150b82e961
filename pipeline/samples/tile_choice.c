/* Reads sizes and losses of all tiles at all qualities from the store's summaries, and takes the
 * best steps, or lets the loop of tile_quality.h find the quality of each. */
#include "pipeline/samples/tile_choice.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "pipeline/samples/tile_loss.h"
#include "pipeline/samples/tile_quality.h"

/* How far the quality of a tile with many feature points may be from that of one with few:
 * docs/quality.md. */
#define DEVIATION 20.0

struct tile {
	uint32_t sizes[SAMPLE_CHOICES_MAX];
	/* The choice that is taken in place of each: a better one may take fewer bytes. */
	uint8_t instead[SAMPLE_CHOICES_MAX];
	uint32_t losses[SAMPLE_CHOICES_MAX];
};

struct chooser {
	const struct sample_grid *grid;
	const float *weights; /* borrowed; of tiles; NULL: all count the same */
	struct tile *tiles;   /* owned */
	uint32_t count, room;
	double windows;                          /* of all tiles, weighted */
	uint32_t (*features)[SAMPLE_SCALES_MAX]; /* owned; of each tile */
	uint32_t features_room;
	uint32_t *counts; /* owned; scale by scale, as in tile_features */
};

static double weight_of(const struct chooser *chooser, uint32_t tile)
{
	return chooser->weights ? (double)chooser->weights[tile] : 1;
}

static void take_tile(struct chooser *chooser, const uint32_t *sizes, const uint32_t *losses)
{
	struct tile *tile = &chooser->tiles[chooser->count];
	const uint32_t best = chooser->grid->choice_count - 1;

	memcpy(tile->sizes, sizes, sizeof(tile->sizes));
	memcpy(tile->losses, losses, sizeof(tile->losses));
	tile->instead[best] = (uint8_t)best;
	for (uint32_t c = best; c-- > 0;) {
		uint8_t next = tile->instead[c + 1];

		tile->instead[c] = sizes[c] < sizes[next] ? (uint8_t)c : next;
	}
}

static int take_face(struct chooser *chooser, const struct sample_face *face)
{
	const uint64_t count = (uint64_t)chooser->count + face->tile_count;
	int rc = ARRAY_RESERVE(chooser->tiles, chooser->room, count, UINT32_MAX);

	if (rc == 0)
		rc = ARRAY_RESERVE(chooser->features, chooser->features_room, count, UINT32_MAX);
	for (uint32_t i = 0; rc == 0 && i < face->tile_count; i++) {
		take_tile(chooser, &face->choice_sizes[i * SAMPLE_CHOICES_MAX],
			  &face->losses[i * SAMPLE_CHOICES_MAX]);
		chooser->windows += face->windows[i] * weight_of(chooser, chooser->count);
		if (face->features)
			memcpy(chooser->features[chooser->count], face->features[i],
			       sizeof(chooser->features[0]));
		chooser->count++;
	}
	return rc;
}

/* Without feature points all tiles are alike, and the order in which single tiles are raised at
 * last goes by these numbers: multiples of the golden ratio, which spread any number of tiles
 * evenly over all. */
static uint32_t scattered(uint32_t tile)
{
	return tile * 2654435769u;
}

static int sort_features(struct chooser *chooser)
{
	const uint32_t scales = chooser->grid->scale_count > 0 ? chooser->grid->scale_count : 1;

	chooser->counts = malloc(((size_t)chooser->count * scales + 1) * sizeof(*chooser->counts));
	if (!chooser->counts)
		return -ENOMEM;
	for (uint32_t scale = 0; scale < scales; scale++)
		for (uint32_t i = 0; i < chooser->count; i++)
			chooser->counts[(size_t)scale * chooser->count + i] =
				chooser->grid->scale_count > 0 ? chooser->features[i][scale]
							       : scattered(i);
	return 0;
}

/* Returns the choice that a quality of 1..100 stands for: the best that is not above it. */
static uint32_t choice_at(const struct chooser *chooser, uint32_t tile, uint8_t quality)
{
	uint32_t choice = 0;

	while (choice + 1 < chooser->grid->choice_count &&
	       chooser->grid->qualities[choice + 1] <= quality)
		choice++;
	return chooser->tiles[tile].instead[choice];
}

static uint32_t tile_bytes(void *user, uint32_t tile, uint8_t quality)
{
	const struct chooser *chooser = user;

	return chooser->tiles[tile].sizes[choice_at(chooser, tile, quality)];
}

/* ---- by quality */

/* Sets choices. */
static int choose_quality(struct tile_choice *out, struct chooser *chooser, uint64_t budget_bytes)
{
	const struct sample_grid *grid = chooser->grid;
	const struct tile_budget_options options = {
		.features = { .tile_count = chooser->count,
			      .scale_count = grid->scale_count > 0 ? grid->scale_count : 1,
			      .counts = chooser->counts },
		.deviation = grid->scale_count > 0 ? DEVIATION : 0,
		.best = grid->qualities[grid->choice_count - 1],
		.worst = grid->qualities[0],
		.budget_bytes = budget_bytes,
		.tile_bytes = tile_bytes,
		.user = chooser,
	};
	struct tile_budget_result result;
	int rc = tile_budget_meet(&result, out->choices, &options);

	/* Deviations raise tiles also at the worst common quality; the smallest are the limit. */
	if (rc == -E2BIG)
		memset(out->choices, grid->qualities[0], chooser->count);
	for (uint32_t i = 0; i < chooser->count; i++)
		out->choices[i] = (uint8_t)choice_at(chooser, i, out->choices[i]);
	return rc == -E2BIG ? 0 : rc;
}

/* ---- by gain */

/* A step of a tile to a better quality. */
struct step {
	double gain; /* weighted loss that it saves for each byte */
	uint32_t tile, bytes;
	uint8_t from, to;
};

static int by_gain(const void *left, const void *right)
{
	const struct step *a = left, *b = right;

	if (a->gain != b->gain)
		return a->gain < b->gain ? 1 : -1;
	if (a->tile != b->tile)
		return a->tile > b->tile ? 1 : -1;
	return (a->from > b->from) - (a->from < b->from);
}

/* Adds the steps from a tile's smallest choice on, each to the choice that gains most for each
 * byte: the convex hull, so that gains fall from step to step. Those that gain nothing come last,
 * because a budget is to be used. */
static uint32_t add_steps(struct step *steps, const struct chooser *chooser, uint32_t tile)
{
	const struct tile *of = &chooser->tiles[tile];
	const double weight = weight_of(chooser, tile);
	uint32_t from = of->instead[0], count = 0;

	for (;;) {
		struct step best = { .gain = -INFINITY };

		for (uint32_t to = from + 1; to < chooser->grid->choice_count; to++) {
			double bytes = (double)of->sizes[to] - of->sizes[from];
			double gain = weight * ((double)of->losses[from] - of->losses[to]) /
				      fmax(bytes, 1);

			if (of->sizes[to] > of->sizes[from] && gain > best.gain)
				best = (struct step){ gain, tile, of->sizes[to] - of->sizes[from],
						      (uint8_t)from, (uint8_t)to };
		}
		if (best.bytes == 0)
			return count;
		steps[count++] = best;
		from = best.to;
	}
}

/* Sets choices: takes the steps that fit, those that gain most first. */
static int choose_gain(struct tile_choice *out, const struct chooser *chooser,
		       uint64_t budget_bytes)
{
	struct step *steps =
		malloc(((size_t)chooser->count + 1) * SAMPLE_CHOICES_MAX * sizeof(*steps));
	uint64_t bytes = out->least_bytes;
	uint32_t count = 0;

	if (!steps)
		return -ENOMEM;
	for (uint32_t i = 0; i < chooser->count; i++) {
		out->choices[i] = chooser->tiles[i].instead[0];
		count += add_steps(steps + count, chooser, i);
	}
	qsort(steps, count, sizeof(*steps), by_gain);
	for (uint32_t s = 0; s < count; s++) {
		const struct step *step = &steps[s];

		/* After a step that did not fit, the tile's later ones start elsewhere. */
		if (out->choices[step->tile] != step->from || bytes + step->bytes > budget_bytes)
			continue;
		out->choices[step->tile] = step->to;
		bytes += step->bytes;
	}
	free(steps);
	return 0;
}

/* ---- the whole */

static int choose(struct tile_choice *out, struct chooser *chooser, enum tile_choice_rule rule,
		  uint64_t budget_bytes)
{
	double loss = 0;
	int rc = 0;

	if (budget_bytes == 0 || budget_bytes < out->least_bytes)
		for (uint32_t i = 0; i < chooser->count; i++)
			out->choices[i] = chooser->tiles[i].instead[0];
	else if (rule == TILE_CHOICE_GAIN)
		rc = choose_gain(out, chooser, budget_bytes);
	else if (chooser->count > 0)
		rc = choose_quality(out, chooser, budget_bytes);
	for (uint32_t i = 0; rc == 0 && i < chooser->count; i++) {
		out->bytes += chooser->tiles[i].sizes[out->choices[i]];
		loss += chooser->tiles[i].losses[out->choices[i]] * weight_of(chooser, i);
		out->counts[out->choices[i]]++;
	}
	out->similarity = 1 - loss / TILE_LOSS_WINDOW / fmax(DBL_MIN, chooser->windows);
	if (rc == 0 && budget_bytes > 0 && budget_bytes < out->least_bytes)
		rc = -E2BIG;
	return rc;
}

int tile_choice_make(struct tile_choice *out, struct samples_store *store,
		     enum tile_choice_rule rule, const float *weights, uint64_t budget_bytes)
{
	struct chooser chooser = { .grid = samples_store_grid(store), .weights = weights };
	struct sample_face face;
	int rc = chooser.grid->choice_count > 1 ? 0 : -EINVAL;

	*out = (struct tile_choice){ 0 };
	samples_store_rewind(store);
	while (rc == 0 && (rc = samples_store_next(store, &face)) == 1)
		rc = take_face(&chooser, &face);
	samples_store_rewind(store);
	if (rc == 0)
		rc = sort_features(&chooser);
	out->tile_count = chooser.count;
	out->choices = malloc((size_t)chooser.count + 1);
	if (rc == 0 && !out->choices)
		rc = -ENOMEM;
	for (uint32_t i = 0; rc == 0 && i < chooser.count; i++) {
		out->least_bytes += chooser.tiles[i].sizes[chooser.tiles[i].instead[0]];
		out->most_bytes += chooser.tiles[i].sizes[chooser.grid->choice_count - 1];
	}
	if (rc == 0)
		rc = choose(out, &chooser, rule, budget_bytes);
	if (rc < 0 && rc != -E2BIG)
		tile_choice_finish(out);
	free(chooser.tiles);
	free(chooser.features);
	free(chooser.counts);
	return rc;
}

void tile_choice_finish(struct tile_choice *choice)
{
	free(choice->choices);
	*choice = (struct tile_choice){ 0 };
}
