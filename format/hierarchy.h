/* Payload of PAGE_HIERARCHY: the multiresolution structure without its geometry (paper P0 3.2).
 *
 * Patches (at most 4000 triangles each) are collected in groups. The patches of a group enter the
 * picture together. To refine a group G means: the patches that G replaces (those whose `finer` is
 * G) leave the picture, and the patches of G enter it. Both sets cover the same surface with the
 * same border, bit for bit. Group 0 is the coarsest: it replaces nothing and is always refined. In
 * a binary tree (the paper's structure) every group holds two patches and replaces one. Where
 * partitions alternate between levels, a group replaces several patches of several groups, and the
 * structure is a directed acyclic graph.
 *
 * Rules, checked by the decoder: A group comes after all groups whose patches it replaces. Its
 * error is not above theirs, and its sphere lies within theirs (saturated). Group 0 has an infinite
 * error; every other number is finite. A group holds 1 to 64 patches, and every group but 0
 * replaces at least one patch. Counts are within the limits of patch.h.
 *
 * A valid cut is a set R of refined groups. R contains group 0, and with every other group all the
 * groups that this group depends on. A patch is shown if its group is in R and its finer group is
 * not. error_m of group G is the error of the picture (metres, one-sided) while G is not
 * refined. */
#ifndef GOPURA_FORMAT_HIERARCHY_H
#define GOPURA_FORMAT_HIERARCHY_H

#include "format/page.h"

#define HIERARCHY_NONE UINT32_MAX

struct hierarchy_patch {
	uint32_t group; /* the group that holds it */
	uint32_t finer; /* the group that replaces it; HIERARCHY_NONE: nothing finer is published */
	uint16_t triangle_count, vertex_count;
	float centre_m[3], radius_m; /* bounding sphere of its vertices */
	float cone_axis[3];          /* mean normal */
	float cone_cos; /* smallest dot product of a normal with the axis; -1: any direction */
};

struct hierarchy_group {
	uint32_t first_patch,
		patch_count;         /* its patches; child i of the page is the object of group i */
	float error_m;               /* INFINITY for group 0 */
	float centre_m[3], radius_m; /* saturated: encloses all groups that refine it */
};

struct hierarchy {
	uint32_t group_count, patch_count;
	struct hierarchy_group *groups;  /* owned */
	struct hierarchy_patch *patches; /* owned; sorted by group */
};

enum { HIERARCHY_GROUPS_MAX = 1 << 20 };

/* Returns 0, -EINVAL if a rule above is broken, or -ENOMEM. Spheres are compared with a tolerance
 * of 1e-5 of the outer radius, to allow for rounding in single precision. */
must_check int hierarchy_check(const struct hierarchy *hierarchy);
/* Appends the payload (docs/hierarchy.md; zstd inside). Returns -ENOMEM, -EINVAL as hierarchy_check
 * does, or the error of out. */
must_check int hierarchy_encode(struct buffer *out, const struct hierarchy *hierarchy);
/* *out is owned by the caller: end it with hierarchy_finish(). It is zeroed on failure. Returns
 * -EBADMSG if the payload is damaged or breaks a rule above, or -ENOMEM. */
must_check int hierarchy_decode(struct hierarchy *out, struct bytes payload);
/* Appends the row of a patch, all but its group; reads it. Failures are kept in out and reader. */
void hierarchy_patch_put(struct buffer *out, const struct hierarchy_patch *patch);
void hierarchy_patch_get(struct hierarchy_patch *out, struct reader *reader);
/* Frees the arrays and zeroes the struct. NULL and zeroed are fine. */
void hierarchy_finish(struct hierarchy *hierarchy);

#endif
