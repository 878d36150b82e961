/* Measures what a release takes with its smallest tiles, and spends what is left of the budget on
 * better ones. */
#include "pipeline/release/publish_budget.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/log.h"
#include "base/map.h"
#include "pipeline/release/finest_patches.h"
#include "pipeline/release/publish_samples.h"
#include "pipeline/samples/tile_use.h"

/* Of the root page besides its children, and of what a locator has for each page, rounded up. */
enum { ROOT_BYTES = 512 };

/* ---- the size of a release */

struct walk {
	struct object_store *objects;
	struct page_child *queue; /* owned; pages whose children are still to be counted */
	uint32_t count, room;
	struct map seen;
	uint64_t bytes;
};

static int count_children(struct walk *walk, const struct page_child *children, uint32_t count)
{
	int rc = 0;

	for (uint32_t i = 0; rc == 0 && i < count; i++) {
		walk->bytes += children[i].size;
		if (!children[i].is_page)
			continue;
		rc = map_add(&walk->seen, hash_key(children[i].hash), walk->count);
		if (rc == 1) {
			rc = ARRAY_RESERVE(walk->queue, walk->room, walk->count + 1, UINT32_MAX);
			if (rc == 0)
				walk->queue[walk->count++] = children[i];
		}
	}
	return rc < 0 ? rc : 0;
}

/* Packs hold the children of each page once (pack.h). */
static int count_bytes(uint64_t *out, struct object_store *objects,
		       const struct page_child *children, uint32_t child_count)
{
	struct walk walk = { .objects = objects, .bytes = ROOT_BYTES };
	struct buffer object;
	int rc = count_children(&walk, children, child_count);

	buffer_init(&object, PAGE_BYTES_MAX);
	for (uint32_t i = 0; rc == 0 && i < walk.count; i++) {
		struct page page = { 0 };

		buffer_clear(&object);
		rc = object_store_read(objects, walk.queue[i].hash, &object);
		if (rc == 0)
			rc = page_decode(&page, buffer_bytes(&object));
		if (rc == 0)
			rc = count_children(&walk, page.children, page.child_count);
		page_finish(&page);
	}
	*out = walk.bytes;
	buffer_finish(&object);
	map_finish(&walk.seen);
	free(walk.queue);
	return rc;
}

/* ---- the choice */

/* Builds the trees of patches, for rays. *out is owned by the caller: free_surface. */
static int make_surface(struct tile_use_patch **out, struct finest_patches *patches,
			const struct lattice *lattice)
{
	int rc = 0;

	*out = calloc((size_t)patches->count + 1, sizeof(**out));
	if (!*out)
		return -ENOMEM;
	for (uint32_t i = 0; rc == 0 && i < patches->count; i++) {
		const struct hierarchy_patch *row = &patches->rows[i];
		struct tile_use_patch *patch = &(*out)[i];

		rc = patch_bvh_init(&patch->bvh, &patches->meshes[i], lattice);
		memcpy(patch->centre_m, row->centre_m, sizeof(patch->centre_m));
		patch->radius_m = row->radius_m;
	}
	return rc;
}

static void free_surface(struct tile_use_patch *surface, uint32_t count)
{
	for (uint32_t i = 0; surface && i < count; i++)
		patch_bvh_finish(&surface[i].bvh);
	free(surface);
}

/* Foretells how much of settled pictures each tile makes up. */
static int weigh(float **weights, struct object_store *objects, struct samples_store *store,
		 const struct page_child *hierarchy, const struct root_page *root)
{
	struct finest_patches patches;
	struct tile_use_patch *surface = NULL;
	int rc = finest_patches_read(&patches, objects, hierarchy);

	*weights = NULL;
	if (rc == 0)
		rc = make_surface(&surface, &patches, &root->lattice);
	if (rc == 0)
		rc = tile_use_make(weights, store, surface, patches.count, root->start_eye_m,
				   root->start_target_m);
	free_surface(surface, patches.count);
	finest_patches_finish(&patches);
	return rc;
}

static int choose(struct tile_choice *choice, struct samples_store *store,
		  enum tile_choice_rule rule, const float *weights, uint64_t bytes)
{
	int rc = tile_choice_make(choice, store, rule, weights, bytes);

	return rc < 0 ? rc : samples_store_choose(store, choice->choices, choice->tile_count);
}

int publish_budget_begin(struct samples_store *store)
{
	struct tile_choice choice;
	int rc = choose(&choice, store, TILE_CHOICE_GAIN, NULL, 0);

	tile_choice_finish(&choice);
	return rc;
}

/* In tenths of a megabyte, rounded up, so that it is a budget that is accepted. */
static double whole_mb(uint64_t bytes)
{
	return ceil((double)bytes / 1e5) / 10;
}

static int refuse(uint64_t budget_bytes, uint64_t least_bytes)
{
	log_error("pipeline",
		  "a budget of %.1f MB is too small: with all tiles at their lowest quality the "
		  "release has %.1f MB; give --budget %.1fMB or more, or reduce [grid] points or "
		  "face_px, or [release] publish_share",
		  (double)budget_bytes / 1e6, whole_mb(least_bytes), whole_mb(least_bytes));
	return -E2BIG;
}

int publish_budget_meet(struct publish_budget_report *report, struct object_store *objects,
			struct samples_store *store, struct page_child *children,
			uint32_t child_count, const struct root_page *root,
			enum tile_choice_rule rule, uint64_t budget_bytes)
{
	const struct sample_grid *grid = samples_store_grid(store);
	struct tile_choice least = { 0 }, choice = { 0 };
	float *weights = NULL;
	uint64_t other_bytes;
	int rc = count_bytes(&report->least_bytes, objects, children, child_count);

	if (rc == 0)
		rc = tile_choice_make(&least, store, rule, NULL, 0);
	if (rc == 0 && report->least_bytes > budget_bytes)
		rc = refuse(budget_bytes, report->least_bytes);
	other_bytes = report->least_bytes - least.bytes;
	if (rc == 0)
		rc = weigh(&weights, objects, store, &children[ROOT_CHILD_HIERARCHY], root);
	if (rc == 0)
		rc = choose(&choice, store, rule, weights, budget_bytes - other_bytes);
	if (rc == 0)
		rc = samples_store_keep_choice(store);
	if (rc == 0)
		rc = publish_samples(objects, store, &children[ROOT_CHILD_SAMPLES]);
	report->most_bytes = other_bytes + choice.most_bytes;
	report->tile_count = choice.tile_count;
	report->choice_count = grid->choice_count;
	memcpy(report->qualities, grid->qualities, sizeof(report->qualities));
	report->similarity = choice.similarity;
	memcpy(report->counts, choice.counts, sizeof(report->counts));
	tile_choice_finish(&least);
	tile_choice_finish(&choice);
	free(weights);
	return rc;
}
