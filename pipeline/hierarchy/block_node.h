/* The files of one node, that is of the work on one block of one stage: what it gives to the
 * hierarchy, the patches that are left for the next stage, and a digest of these. So a build that
 * was cut off goes on where it was. */
#ifndef GOPURA_PIPELINE_HIERARCHY_BLOCK_NODE_H
#define GOPURA_PIPELINE_HIERARCHY_BLOCK_NODE_H

#include "base/bytes.h"
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
	struct lattice_counts counts; /* only of the first stage */
};

/* Names a vertex that several blocks use, which is the same in all of them: the node in whose left
 * vertices it was first and its index there, or BORDER_NODE and its number in struct
 * block_border. */
typedef uint64_t block_key;

#define BLOCK_NO_KEY UINT64_MAX
#define BORDER_NODE  (UINT32_MAX - 1)

static inline block_key block_key_of(uint32_t node, uint32_t index)
{
	return (uint64_t)node << 32 | index;
}

/* The patches that are left. Their triangles index these vertices; finer as in the rows. */
struct block_left {
	struct live_patches patches;
	uint32_t vertex_count;
	struct lattice_vertex *vertices; /* owned */
	block_key *keys; /* owned; for each vertex that other nodes have too, else BLOCK_NO_KEY */
};

/* What the next stage must know of them before it reads them. */
struct block_digest {
	uint32_t patch_count;
	struct block_digest_patch {
		uint32_t triangle_count;
		float centre[3]; /* coarse steps */
	} * patches;             /* owned */
	uint32_t use_count;
	struct block_use {
		uint32_t patch;
		block_key key;
	} * uses; /* owned; the vertices with a key of each patch */
	uint32_t touch_count;
	struct block_touch {
		uint32_t a, b;  /* two patches */
		uint32_t count; /* vertices that one passes on to the other */
	} * touches;            /* owned */
};

void block_result_init(struct block_result *result);
void block_result_finish(struct block_result *result); /* NULL is fine */

void block_left_finish(struct block_left *left);       /* NULL and zeroed are fine */
void block_digest_finish(struct block_digest *digest); /* NULL and zeroed are fine */

/* Writes the files folder/digest-N, left-N and, last, node-N, each atomically. Returns the errors
 * of the disk, or -ENOMEM. */
must_check int block_node_write(const struct block_result *result, const struct block_left *left,
				const char *folder, uint32_t node);
/* Returns whether the files are there. */
bool block_node_exists(const char *folder, uint32_t node);
/* *out is owned by the caller, also on failure. Return -EBADMSG if the file is damaged, the errors
 * of the disk, or -ENOMEM. */
must_check int block_result_read(struct block_result *out, const char *folder, uint32_t node);
must_check int block_left_read(struct block_left *out, const char *folder, uint32_t node);
must_check int block_digest_read(struct block_digest *out, const char *folder, uint32_t node);

#endif
