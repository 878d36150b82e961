/* The multiresolution hierarchy of a scan (paper P0 3.2): the finest patches, then coarser and
 * coarser ones. Each level is made from the one below by merging, simplifying and dividing again.
 * docs/hierarchy.md compares the two kinds.
 *
 * A level is divided into groups. The patches of a group become one surface, which is simplified
 * with every vertex locked that another group also uses. So the border that two patches of any cut
 * share is equal bit for bit, normals and colours included. */
#ifndef GOPURA_PIPELINE_HIERARCHY_MULTIRES_H
#define GOPURA_PIPELINE_HIERARCHY_MULTIRES_H

#include "format/hierarchy.h"
#include "pipeline/hierarchy/lattice_mesh.h"

enum multires_kind {
	MULTIRES_GROUPS, /* new groups on every level: each border is unlocked one level up */
	MULTIRES_TREE    /* the paper's binary tree: borders stay until siblings join */
};

struct multires_options {
	enum multires_kind kind;
	uint32_t patch_triangles; /* maximum in a patch, 1..PATCH_TRIANGLES_MAX; 0: the default */
	uint32_t group_patches;   /* about so many in a group, 2..32; else the default */
	uint32_t top_triangles;   /* maximum in the coarsest cut; 0: the default */
	uint32_t jobs;            /* threads; 0: one per processor. The result is the same. */
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
	uint32_t top_bytes;                                /* size of the object of group 0 */
};

/* Receives the groups' objects in the order in which they are made, the finest first: object number
 * n will be group (group_count - 1 - n) of the hierarchy. object is borrowed for the call. loss_m4
 * is the cost of not showing the group: squared distance times area of the costliest collapse in
 * what replaces it, never less than the loss of finer groups; infinite for the last. A negative
 * errno ends the build. */
struct multires_sink {
	int (*put)(void *user, struct bytes object, float loss_m4);
	void *user;
};

/* Builds the hierarchy. It works on the mesh's own vertices: the mesh is used up, whatever is
 * returned. *out is owned by the caller; zeroed on failure. Returns -ENOMEM, the sink's error,
 * -E2BIG if the coarsest cut does not fit in one group or there are too many levels, -EINVAL if a
 * surface cannot be divided, or -EPROTO if the result breaks a rule of format/hierarchy.h. */
must_check int multires_build(struct hierarchy *out, struct multires_stats *stats,
			      struct lattice_mesh *mesh, const struct multires_options *options,
			      const struct multires_sink *sink);

#endif
