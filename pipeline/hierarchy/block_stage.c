/* Divides the graph of patches and finds who uses the vertices that nodes share. */
#include "pipeline/hierarchy/block_stage.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "pipeline/hierarchy/graph.h"

enum { PATCHES_A_BLOCK_MIN = 16, TOUCH_WEIGHT = 4 /* for each vertex; joints weigh 1 */ };

/* ---- blocks */

static uint32_t blocks_for(const struct block_stage *stage, uint32_t patch_count,
			   uint32_t block_triangles)
{
	uint64_t blocks = (stage->triangle_count + block_triangles - 1) / block_triangles;

	if (blocks > patch_count / PATCHES_A_BLOCK_MIN)
		blocks = patch_count / PATCHES_A_BLOCK_MIN;
	return blocks < 1 ? 1 : (uint32_t)blocks;
}

/* ---- what they share */

static int compare_shared(const void *left, const void *right)
{
	const struct block_shared *a = left, *b = right;

	if (a->key != b->key)
		return a->key < b->key ? -1 : 1;
	return a->low < b->low ? -1 : a->low > b->low;
}

/* One entry for each use, with the patch in place of the block; later equal keys become one. */
static int add_uses(struct block_stage *stage, const struct block_digest *digest, uint32_t node)
{
	int rc = ARRAY_RESERVE(stage->shared, stage->shared_room,
			       (uint64_t)stage->shared_count + digest->use_count, UINT32_MAX);

	if (rc < 0)
		return rc;
	for (uint32_t u = 0; u < digest->use_count; u++) {
		uint32_t patch = stage->first_patch[node] + digest->uses[u].patch;

		stage->shared[stage->shared_count++] =
			(struct block_shared){ digest->uses[u].key, patch, patch };
	}
	return 0;
}

static void join_equal(struct block_stage *stage)
{
	uint32_t kept = 0;

	for (uint32_t i = 0; i < stage->shared_count; i++) {
		struct block_shared item = stage->shared[i];
		struct block_shared *last = kept > 0 ? &stage->shared[kept - 1] : NULL;
		uint32_t block = stage->block_of_patch[item.low];

		if (!last || last->key != item.key) {
			stage->shared[kept++] = (struct block_shared){ item.key, block, block };
			continue;
		}
		last->low = block < last->low ? block : last->low;
		last->high = block > last->high ? block : last->high;
	}
	stage->shared_count = kept;
}

uint32_t block_stage_find(const struct block_stage *stage, block_key key)
{
	uint32_t low = 0, high = stage->shared_count;

	while (low < high) {
		uint32_t middle = low + (high - low) / 2;

		if (stage->shared[middle].key < key)
			low = middle + 1;
		else
			high = middle;
	}
	return low < stage->shared_count && stage->shared[low].key == key ? low : BLOCK_NONE;
}

/* ---- the graph of the patches */

struct patches {
	struct graph graph;
	float (*at)[3];
};

static int add_patches(struct patches *patches, struct block_stage *stage,
		       const struct block_digest *digest, uint32_t node)
{
	uint32_t first = stage->first_patch[node];
	int rc = 0;

	for (uint32_t p = 0; p < digest->patch_count; p++) {
		memcpy(patches->at[first + p], digest->patches[p].centre, sizeof(*patches->at));
		patches->graph.node_weights[first + p] = (int32_t)digest->patches[p].triangle_count;
	}
	for (uint32_t t = 0; rc == 0 && t < digest->touch_count; t++)
		rc = graph_add(&patches->graph, first + digest->touches[t].a,
			       first + digest->touches[t].b,
			       TOUCH_WEIGHT * (int32_t)digest->touches[t].count);
	return rc < 0 ? rc : add_uses(stage, digest, node);
}

/* Patches of different nodes touch where they have a key in common. Within a node they are joined
 * already. */
static int join_nodes(struct patches *patches, const struct block_stage *stage)
{
	int rc = 0;

	for (uint32_t i = 1; rc == 0 && i < stage->shared_count; i++) {
		const struct block_shared *item = &stage->shared[i];

		if (item->key == item[-1].key && item->low != item[-1].low)
			rc = graph_add(&patches->graph, item[-1].low, item->low, TOUCH_WEIGHT);
	}
	return rc;
}

static int divide(struct block_stage *stage, const struct block_digest *digests,
		  uint32_t block_triangles, bool whole)
{
	uint32_t count = stage->first_patch[stage->node_count];
	struct patches patches = { .at = malloc((count + (size_t)1) * sizeof(*patches.at)) };
	int rc = graph_init(&patches.graph, count);

	stage->block_of_patch = calloc(count + (size_t)1, sizeof(*stage->block_of_patch));
	if (!patches.at || !stage->block_of_patch)
		rc = -ENOMEM;
	for (uint32_t n = 0; rc == 0 && n < stage->node_count; n++)
		rc = add_patches(&patches, stage, &digests[n], n);
	if (rc == 0) {
		if (stage->shared_count > 0)
			qsort(stage->shared, stage->shared_count, sizeof(*stage->shared),
			      compare_shared);
		rc = join_nodes(&patches, stage);
	}
	stage->block_count = whole ? 1 : blocks_for(stage, count, block_triangles);
	if (rc == 0)
		rc = graph_connect(&patches.graph, patches.at, 1);
	if (rc == 0)
		rc = graph_divide(stage->block_of_patch, &patches.graph, stage->block_count, NULL);
	if (rc == 0)
		join_equal(stage);
	graph_finish(&patches.graph);
	free(patches.at);
	return rc;
}

/* ---- the whole */

int block_stage_create(struct block_stage *out, const char *folder, uint32_t number,
		       uint32_t first_node, uint32_t node_count, uint32_t block_triangles,
		       bool whole)
{
	struct block_digest *digests = calloc(node_count, sizeof(*digests));
	int rc = digests ? 0 : -ENOMEM;

	*out = (struct block_stage){
		.number = number,
		.first_node = first_node,
		.node_count = node_count,
		.first_patch = calloc(node_count + (size_t)1, sizeof(*out->first_patch)),
	};
	if (!out->first_patch)
		rc = -ENOMEM;
	for (uint32_t n = 0; rc == 0 && n < node_count; n++) {
		rc = block_digest_read(&digests[n], folder, first_node + n);
		out->first_patch[n + 1] = out->first_patch[n] + digests[n].patch_count;
		for (uint32_t p = 0; p < digests[n].patch_count; p++)
			out->triangle_count += digests[n].patches[p].triangle_count;
	}
	if (rc == 0)
		rc = divide(out, digests, block_triangles, whole);
	for (uint32_t n = 0; digests && n < node_count; n++)
		block_digest_finish(&digests[n]);
	free(digests);
	if (rc < 0)
		block_stage_finish(out);
	return rc;
}

void block_stage_finish(struct block_stage *stage)
{
	if (!stage)
		return;
	free(stage->first_patch);
	free(stage->block_of_patch);
	free(stage->shared);
	*stage = (struct block_stage){ 0 };
}
