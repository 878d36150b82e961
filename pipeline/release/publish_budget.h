/* Makes a release take a number of bytes: chooses the qualities of its tiles. docs/quality.md. */
#ifndef GOPURA_PIPELINE_RELEASE_PUBLISH_BUDGET_H
#define GOPURA_PIPELINE_RELEASE_PUBLISH_BUDGET_H

#include "format/root_page.h"
#include "pipeline/release/object_store.h"
#include "pipeline/samples/tile_choice.h"

struct publish_budget_report {
	uint64_t least_bytes,
		most_bytes; /* the smallest and the largest release that are possible */
	uint32_t tile_count;
	uint32_t choice_count;
	uint8_t qualities[SAMPLE_CHOICES_MAX];
	uint32_t counts[SAMPLE_CHOICES_MAX]; /* tiles of each quality */
	double similarity;                   /* mean SSIM of tiles, by their use, 0..1 */
};

/* Chooses the smallest tiles; publish_samples then makes the smallest samples page. The store must
 * have a choice. Errors as of tile_choice_make. */
must_check int publish_budget_begin(struct samples_store *store);

/* Chooses the tiles with which a release of these children has at most budget_bytes, as close as
 * it can, keeps that choice in the store's folder, and makes the samples page anew:
 * children[ROOT_CHILD_SAMPLES]. All other children are final, and that one was made after
 * publish_budget_begin. Returns -E2BIG (logged, with the smallest size that is possible) if not
 * even those fit; the other errors are logged too. */
must_check int publish_budget_meet(struct publish_budget_report *report,
				   struct object_store *objects, struct samples_store *store,
				   struct page_child *children, uint32_t child_count,
				   const struct root_page *root, enum tile_choice_rule rule,
				   uint64_t budget_bytes);

#endif
