/* The outline of a part on one patch, and the area of the patch inside it, computed from the
 * labels. Pure; positions are in lattice steps from the base of the BVH. */
#ifndef GOPURA_RENDER_PATCHES_OUTLINE_H
#define GOPURA_RENDER_PATCHES_OUTLINE_H

#include "format/label.h"
#include "geometry/patch_bvh.h"

struct outline_line {
	float at[2][3];
	float normal[3]; /* of the triangle it lies on, unit length */
};

struct outline {
	struct outline_line *lines; /* owned, like the next two */
	uint16_t *whole;            /* triangles entirely inside: corners, as indices of the BVH */
	/* the inner area of the other triangles: corners, three per triangle */
	float (*within)[3];
	uint32_t line_count, whole_count, within_count;
	uint32_t line_room, whole_room, within_room; /* private */
};

/* Computes the outline of a part on one patch. bvh is that of the patch; patch is its index within
 * its group; part is the index of the part in the group's labels. The caller finishes *out. Returns
 * 0 or -ENOMEM. */
must_check int outline_create(struct outline *out, const struct patch_bvh *bvh,
			      const struct label_group *labels, uint32_t patch, uint32_t part);
void outline_finish(struct outline *outline); /* Frees it; a zeroed outline is fine. */

#endif
