/* The work on one node of the block tree: a leaf builds its levels from the scan, an inner node
 * from what its children left over. Reads files of a folder and writes one. */
#ifndef GOPURA_PIPELINE_HIERARCHY_BLOCK_WORK_H
#define GOPURA_PIPELINE_HIERARCHY_BLOCK_WORK_H

#include "pipeline/hierarchy/block_border.h"
#include "pipeline/hierarchy/block_tree.h"
#include "pipeline/hierarchy/multires.h"

/* What all nodes share. */
struct block_site {
	struct block_scan scan;
	struct block_tree tree;
	struct block_look look;
	struct block_border border;
	struct multires_options options; /* with no defaults left */
	const char *folder;              /* of the files; borrowed */
};

/* Does the work on a node whose children are done, and writes its file (block_node.h); does nothing
 * if it is there. jobs: threads. Returns the errors of multires_build and of the disk. */
must_check int block_work(const struct block_site *site, uint32_t node, uint32_t jobs);

#endif
