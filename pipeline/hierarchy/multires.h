/* The multiresolution hierarchy of a scan (paper P0 3.2): the finest patches, then coarser and
 * coarser ones. Each level is made from the one below by merging, simplifying and dividing again.
 * docs/hierarchy.md compares the two kinds.
 *
 * A level is divided into groups. The patches of a group become one surface, which is simplified
 * with every vertex locked that another group also uses. So the border that two patches of any cut
 * share is equal bit for bit, normals and colours included. */
#ifndef GOPURA_PIPELINE_HIERARCHY_MULTIRES_H
#define GOPURA_PIPELINE_HIERARCHY_MULTIRES_H

#include <stdbool.h>

#include "base/processes.h"
#include "format/hierarchy.h"
#include "pipeline/hierarchy/lattice_mesh.h"

enum multires_kind {
	MULTIRES_GROUPS, /* new groups on every level: each border is unlocked one level up */
	MULTIRES_TREE    /* the paper's binary tree: borders stay until siblings join */
};

enum multires_simplifier {
	MULTIRES_QUADRIC, /* simplify.h */
	MULTIRES_FEATURES /* simplify_features.h */
};

struct multires_options {
	enum multires_kind kind;
	enum multires_simplifier simplifier;
	uint32_t patch_triangles; /* maximum in a patch, 1..PATCH_TRIANGLES_MAX; 0: the default */
	uint32_t group_patches;   /* about so many in a group, 2..32; else the default */
	uint32_t top_triangles;   /* maximum in the coarsest cut; 0: the default */
	uint32_t block_triangles; /* about so many of the scan in a block; 0: the default */
	double step_max_m;        /* the largest step of the lattice; 0: the default */
	/* These two decide no byte of the result. */
	uint32_t jobs;      /* threads or processes; 0: one per processor */
	struct shard shard; /* of several machines that build it together */
};

enum { MULTIRES_LEVELS_MAX = 64 };

struct multires_level {
	uint64_t triangle_count;
	uint32_t patch_count, group_count;
};

struct multires_stats {
	uint32_t level_count;
	struct multires_level levels[MULTIRES_LEVELS_MAX]; /* [0] is the finest */
	uint64_t object_bytes, vertex_count;               /* of all groups */
};

/* Receives the groups' objects in the order in which they are made, the finest first. object is
 * borrowed for the call. loss_m4 is the cost of not showing the group: squared distance times area
 * of the costliest collapse in what replaces it, never less than the loss of finer groups; infinite
 * for the last of the root. A negative errno ends the build. */
struct multires_sink {
	int (*put)(void *user, struct bytes object, float loss_m4);
	void *user;
};

#define NO_GROUP UINT32_MAX

struct sphere {
	double centre[3], radius; /* in metres */
};

/* A patch that no coarser one replaces yet. Vertices are given by their index in the node's mesh.
 */
struct live_patch {
	uint32_t (*triangles)[3]; /* owned */
	uint32_t triangle_count;
	uint32_t finer;          /* number of the group that replaces it, or NO_GROUP */
	double error_m, loss_m4; /* of that group; 0 if there is none */
	struct sphere finer_sphere;
	float centre[3]; /* coarse steps; approximate position */
};

struct live_patches {
	struct live_patch *items; /* owned */
	uint32_t count, room;
};

/* Free the triangles. */
void live_patch_finish(struct live_patch *patch);
void live_patches_finish(struct live_patches *patches); /* NULL is fine */
/* patch is taken, also on failure. Returns -ENOMEM. */
must_check int live_patches_add(struct live_patches *patches, struct live_patch patch);

/* What there is to do for one block of one stage (docs/hierarchy.md). */
struct multires_node {
	struct lattice_mesh mesh;    /* owned; of the scan, with its triangles */
	uint8_t *pinned;             /* owned; for each vertex, 1: other blocks use it too */
	struct live_patches patches; /* owned; not of the scan: what is left of it */
	/* Groups of other nodes that patches name as finer have the numbers below this; those made
	 * here follow in the order of making. */
	uint32_t first_number;
	uint32_t level;          /* number of levels below */
	uint64_t scan_triangles; /* of the whole scan */
	bool is_root;            /* nothing is pinned, and levels are made up to the coarsest cut */
};

/* Frees everything. NULL and zeroed are fine. */
void multires_node_finish(struct multires_node *node);

/* Sets the values that options leave to the default, for a scan of so many triangles. */
void multires_set_defaults(struct multires_options *options, uint64_t scan_triangles);

/* Builds the levels of the root up to the coarsest cut, or one level; its coarser patches then stay
 * in node->patches. *made are the rows in the order of making, owned by the caller and zeroed on
 * failure: group numbers count from first_number. Options have no defaults left. Returns -ENOMEM,
 * the sink's error, -E2BIG if the coarsest cut does not fit in one group or there are too many
 * levels, or -EINVAL if a surface cannot be divided. */
must_check int multires_build(struct hierarchy *made, struct multires_stats *stats,
			      struct multires_node *node, const struct multires_options *options,
			      const struct multires_sink *sink);

#endif
