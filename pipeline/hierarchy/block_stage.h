/* The division of what one stage of the build left into the blocks of the next (docs/hierarchy.md).
 * METIS cuts the graph of the patches where few vertices are shared. The border of the blocks
 * before was locked and is dense, so it is not cut again. The division depends on the patches
 * alone: it decides bytes. */
#ifndef GOPURA_PIPELINE_HIERARCHY_BLOCK_STAGE_H
#define GOPURA_PIPELINE_HIERARCHY_BLOCK_STAGE_H

#include "pipeline/hierarchy/block_node.h"

/* A vertex that several nodes of the stage before have, and the first and last block that use it.
 */
struct block_shared {
	block_key key;
	uint32_t low, high;
};

struct block_stage {
	uint32_t number;                 /* 1 or more: stage 0 is that of the scan */
	uint32_t first_node, node_count; /* the nodes of the stage before */
	uint32_t block_count;
	uint32_t
		*first_patch; /* owned; for each of these nodes, and the number of all at the end */
	uint32_t *block_of_patch;    /* owned; for each patch of all these nodes, in their order */
	struct block_shared *shared; /* owned; sorted by key */
	uint32_t shared_count, shared_room;
	uint64_t triangle_count; /* of all patches */
};

/* Divides what the nodes left into blocks of about block_triangles triangles, or into one if whole.
 * *out is owned by the caller; zeroed on failure. Returns -EBADMSG if a file is damaged, -ENOMEM or
 * the errors of the disk. */
must_check int block_stage_create(struct block_stage *out, const char *folder, uint32_t number,
				  uint32_t first_node, uint32_t node_count,
				  uint32_t block_triangles, bool whole);
void block_stage_finish(struct block_stage *stage); /* NULL and zeroed are fine */

/* Returns the index of a key in stage->shared, or BLOCK_NONE. */
uint32_t block_stage_find(const struct block_stage *stage, block_key key);

#define BLOCK_NONE UINT32_MAX

#endif
