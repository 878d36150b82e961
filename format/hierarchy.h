/* Payload of PAGE_HIERARCHY: the multiresolution structure without its geometry (paper P0 3.2).
 *
 * Patches (at most 4000 triangles) hang together in groups. The patches of a group were made by
 * nobody but themselves; refining a group G means: the patches it `replaces` (those whose `finer`
 * is G) leave the picture and the patches of G enter it, both covering the same surface with the
 * same border, bit for bit. Group 0 is the top: it replaces nothing and is always shown or
 * refined. A binary tree (the paper's) is the case where every group holds two patches and
 * replaces one; where partitions alternate between levels a group replaces several patches of
 * several groups, and the structure is a directed acyclic graph.
 *
 * Rules, checked by the decoder: a group comes after all groups whose patches it replaces; its
 * error is not above theirs and its sphere lies within theirs (saturated), but for group 0 whose
 * error is infinite. A group holds 1 to 64 patches, and every group but 0 replaces at least one;
 * counts are within patch.h's limits; every number is finite but the one infinity.
 *
 * A valid cut is a set R of refined groups with 0 in R such that every group in R other than 0
 * has all groups it depends on in R; shown is each patch whose group is in R and whose finer is
 * not. error_m(G) is what the picture is wrong by (metres, one-sided) while G is not refined. */
#ifndef GOPURA_FORMAT_HIERARCHY_H
#define GOPURA_FORMAT_HIERARCHY_H

#include "format/page.h"

#define HIERARCHY_NONE UINT32_MAX

struct hierarchy_patch {
	uint32_t group; /* that holds it */
	uint32_t finer; /* group that replaces it, or HIERARCHY_NONE: nothing finer is published */
	uint16_t triangle_count, vertex_count;
	float centre_m[3], radius_m; /* bounding sphere of its vertices */
	float cone_axis[3];          /* mean normal */
	float cone_cos;              /* smallest dot of a normal with the axis; -1: any direction */
};

struct hierarchy_group {
	uint32_t first_patch,
		patch_count;         /* its patches; child i of the page is group i's object */
	float error_m;               /* INFINITY for group 0 */
	float centre_m[3], radius_m; /* saturated: encloses every group that refines it */
};

struct hierarchy {
	uint32_t group_count, patch_count;
	struct hierarchy_group *groups;  /* owned */
	struct hierarchy_patch *patches; /* owned; sorted by group */
};

enum { HIERARCHY_GROUPS_MAX = 1 << 20 };

/* 0, or -EINVAL where a rule above is broken. Spheres are compared with a tolerance of 1e-5 of the
 * outer one, which is what single precision loses. */
must_check int hierarchy_check(const struct hierarchy *hierarchy);
/* Appends the payload (docs/hierarchy.md; zstd inside). -ENOMEM; -EINVAL as hierarchy_check. */
must_check int hierarchy_encode(struct buffer *out, const struct hierarchy *hierarchy);
/* -EBADMSG where a rule above is broken, -ENOMEM. *out is zeroed on failure. */
must_check int hierarchy_decode(struct hierarchy *out, struct bytes payload);
void hierarchy_finish(struct hierarchy *hierarchy);

#endif
