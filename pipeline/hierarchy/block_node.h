/* What the work on one node of the block tree gives: its groups, and the patches that are left for
 * its parent. In a file of its own, so that a build that was cut off goes on where it was. */
#ifndef GOPURA_PIPELINE_HIERARCHY_BLOCK_NODE_H
#define GOPURA_PIPELINE_HIERARCHY_BLOCK_NODE_H

#include "base/bytes.h"
#include "pipeline/hierarchy/block_border.h"
#include "pipeline/hierarchy/multires.h"

/* A group of any node. */
struct block_group {
	uint32_t node, number; /* number: in the order of making, from 0 */
};

struct block_result {
	/* Groups of other nodes that are named here: number n of the rows means others[n], and
	 * other_count + n the node's own group n. */
	struct block_group *others; /* owned */
	uint32_t other_count;
	struct hierarchy made; /* owned; in the order of making */
	float *losses_m4;      /* owned; for each group */
	uint32_t *sizes;       /* owned; of each group's object, bytes */
	struct buffer objects; /* all objects, one after the other */
	struct multires_stats stats;
	struct lattice_counts counts; /* only of a leaf */
	/* What is left: patches whose triangles index these vertices; finer as in the rows. */
	struct live_patches left;
	uint32_t vertex_count;
	struct lattice_vertex *vertices; /* owned */
	uint32_t *borders; /* owned; for each vertex, its number in struct block_border, or NONE */
};

void block_result_init(struct block_result *result);
void block_result_finish(struct block_result *result); /* NULL is fine */

/* Writes folder/node-N atomically. Returns the errors of the disk, or -ENOMEM. */
must_check int block_result_write(const struct block_result *result, const char *folder,
				  uint32_t node);
/* Returns whether that file is there. */
bool block_result_exists(const char *folder, uint32_t node);
/* *out is owned by the caller, also on failure. Returns -EBADMSG if the file is damaged, the errors
 * of the disk, or -ENOMEM. */
must_check int block_result_read(struct block_result *out, const char *folder, uint32_t node);

#endif
