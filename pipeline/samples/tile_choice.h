/* Chooses the quality at which each tile of a sample store is published, so that all of them
 * together take a number of bytes (docs/quality.md). The result depends on the store alone. */
#ifndef GOPURA_PIPELINE_SAMPLES_TILE_CHOICE_H
#define GOPURA_PIPELINE_SAMPLES_TILE_CHOICE_H

#include "pipeline/samples/sample_store.h"

struct tile_choice {
	uint32_t tile_count;
	uint8_t *choices;                 /* owned; of the grid's qualities, in the store's order */
	uint64_t bytes;                   /* of the chosen tiles */
	uint64_t least_bytes, most_bytes; /* of the smallest and of the best ones */
	double similarity; /* mean SSIM of what shows in the chosen tiles, weighted */
	uint32_t counts[SAMPLE_CHOICES_MAX]; /* tiles of each quality */
};

enum tile_choice_rule {
	/* The most similarity for the bytes: steps to a better quality are taken in the order of
	 * what a byte gains, weighted. */
	TILE_CHOICE_GAIN,
	/* By feature points if the store's grid has them, and else the same quality for all tiles,
	 * but for those, spread evenly, that are one better because there are bytes left. */
	TILE_CHOICE_QUALITY
};

/* Chooses for a store with a choice. The store is read from its first face on. weights: of each
 * tile (tile_use.h); NULL: all count the same. budget_bytes: of all tiles; 0: the smallest. Returns
 * -E2BIG if not even those fit (*out is then of them), -EINVAL if the store has no choice, -ENOMEM,
 * or -EBADMSG. Otherwise *out is owned by the caller; zeroed on other failures. */
must_check int tile_choice_make(struct tile_choice *out, struct samples_store *store,
				enum tile_choice_rule rule, const float *weights,
				uint64_t budget_bytes);
void tile_choice_finish(struct tile_choice *choice); /* zeroed is fine */

#endif
