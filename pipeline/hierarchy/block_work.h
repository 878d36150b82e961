/* The work on one block of one stage: in stage 0 a block of the scan, later a block of patches that
 * the stage before left over. Reads files of a folder and writes those of one node. */
#ifndef GOPURA_PIPELINE_HIERARCHY_BLOCK_WORK_H
#define GOPURA_PIPELINE_HIERARCHY_BLOCK_WORK_H

#include "pipeline/hierarchy/block_border.h"
#include "pipeline/hierarchy/block_stage.h"
#include "pipeline/hierarchy/multires.h"

/* What the blocks of a stage share. */
struct block_site {
	struct block_scan scan;
	struct block_cells cells;
	struct block_look look;
	struct block_border border;
	struct multires_options options; /* with no defaults left */
	const char *folder;              /* of the files; borrowed */
	struct block_stage stage;        /* number 0: the scan itself, and nothing else is set */
	uint32_t first_node;             /* node of the stage's block 0 */
	bool is_last;                    /* its only block becomes the rest of the hierarchy */
};

/* Does the work on a block and writes the files of its node (block_node.h); does nothing if they
 * are there. jobs: threads. Returns the errors of multires_build and of the disk. */
must_check int block_work(const struct block_site *site, uint32_t block, uint32_t jobs);

#endif
