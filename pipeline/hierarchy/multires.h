/* The multiresolution hierarchy of a scan (paper P0 3.2): finest patches, then coarser and coarser
 * ones, each level made of the one below by merging, simplifying and dividing again.
 * docs/hierarchy.md compares the two kinds.
 *
 * A level is divided into groups; the patches of a group become one surface, which is simplified
 * with every vertex locked that another group uses too. So what two patches of any cut share, they
 * share bit for bit, normals and colours included. */
#ifndef GOPURA_PIPELINE_HIERARCHY_MULTIRES_H
#define GOPURA_PIPELINE_HIERARCHY_MULTIRES_H

#include "format/hierarchy.h"
#include "pipeline/hierarchy/lattice_mesh.h"

enum multires_kind {
	MULTIRES_GROUPS, /* new groups on every level: every border is unlocked one level up */
	MULTIRES_TREE    /* the paper's binary tree: a node's border stays till its sibling joins */
};

struct multires_options {
	enum multires_kind kind;
	uint32_t patch_triangles; /* the most in a patch, 1..PATCH_TRIANGLES_MAX; 0: the default */
	uint32_t group_patches;   /* about so many in a group, 2..32; 0: the default */
	uint32_t top_triangles;   /* the coarsest cut has at most so many; 0: the default */
	uint32_t jobs;            /* threads; 0: one a processor. The result is the same. */
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
	uint32_t top_bytes;                                /* of the object of group 0 */
};

/* Takes the groups' objects in the order they are made, which is finest first: number n will be
 * group (group_count - 1 - n) of the hierarchy. loss_m4: what is lost where the group is not shown,
 * squared distance times area of the costliest collapse of its replacement, never less than of what
 * is finer; infinite for the last. Negative errno ends the build. */
struct multires_sink {
	int (*put)(void *user, struct bytes object, float loss_m4);
	void *user;
};

/* Works on the mesh's own vertices: the mesh is used up, whatever is returned. *out is owned by the
 * caller. -ENOMEM, what the sink returns, or -E2BIG: this tree's coarsest cut does not fit in one
 * group. */
must_check int multires_build(struct hierarchy *out, struct multires_stats *stats,
			      struct lattice_mesh *mesh, const struct multires_options *options,
			      const struct multires_sink *sink);

#endif
