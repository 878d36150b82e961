/* Reads the sizes of all tiles at all qualities from the store's summaries, and lets the loop of
 * tile_quality.h find the quality of each. */
#include "pipeline/samples/tile_choice.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "pipeline/samples/tile_quality.h"

/* How far the quality of a tile with many feature points may be from that of one with few:
 * docs/quality.md. */
#define DEVIATION 20.0

struct tile {
	uint32_t sizes[SAMPLE_CHOICES_MAX];
	/* The choice that is taken in place of each: a better one may take fewer bytes. */
	uint8_t instead[SAMPLE_CHOICES_MAX];
};

struct chooser {
	const struct sample_grid *grid;
	struct tile *tiles; /* owned */
	uint32_t count, room;
	uint32_t (*features)[SAMPLE_SCALES_MAX]; /* owned; of each tile */
	uint32_t features_room;
	uint32_t *counts; /* owned; scale by scale, as in tile_features */
};

static void take_tile(struct chooser *chooser, const uint32_t *sizes)
{
	struct tile *tile = &chooser->tiles[chooser->count];
	const uint32_t best = chooser->grid->choice_count - 1;

	memcpy(tile->sizes, sizes, sizeof(tile->sizes));
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
		take_tile(chooser, &face->choice_sizes[i * SAMPLE_CHOICES_MAX]);
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

static int choose(struct tile_choice *out, struct chooser *chooser, uint64_t budget_bytes)
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
	int rc = 0;

	if (budget_bytes == 0 || chooser->count == 0)
		memset(out->choices, grid->qualities[0], chooser->count);
	else
		rc = tile_budget_meet(&result, out->choices, &options);
	/* Deviations take qualities below the worst common one; the smallest bytes are the limit.
	 */
	if (rc == -E2BIG && budget_bytes >= out->least_bytes) {
		memset(out->choices, grid->qualities[0], chooser->count);
		rc = 0;
	}
	for (uint32_t i = 0; i < chooser->count; i++) {
		uint32_t choice = choice_at(chooser, i, out->choices[i]);

		out->choices[i] = (uint8_t)choice;
		out->bytes += chooser->tiles[i].sizes[choice];
		out->counts[choice]++;
	}
	return rc;
}

int tile_choice_make(struct tile_choice *out, struct samples_store *store, uint64_t budget_bytes)
{
	struct chooser chooser = { .grid = samples_store_grid(store) };
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
		rc = choose(out, &chooser, budget_bytes);
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
