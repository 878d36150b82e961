/* The area of a part on one patch, computed from the labels. Pure; positions are in lattice units.
 */
#ifndef GOPURA_RENDER_PATCHES_PART_AREA_H
#define GOPURA_RENDER_PATCHES_PART_AREA_H

#include "format/label.h"
#include "geometry/patch_bvh.h"

struct part_area {
	uint16_t *whole; /* triangles entirely inside: corners, as indices of the BVH; owned */
	/* the inner area of the triangles that the part's border crosses: corners, three per
	 * triangle; owned */
	float (*within)[3];
	uint32_t whole_count, within_count; /* corners */
	uint32_t whole_room, within_room;   /* private */
};

/* Computes the area of a part on one patch. bvh is that of the patch; patch is its index within its
 * group; part is the index of the part in the group's labels. The caller finishes *out. Returns 0
 * or -ENOMEM. */
must_check int part_area_create(struct part_area *out, const struct patch_bvh *bvh,
				const struct label_group *labels, uint32_t patch, uint32_t part);
void part_area_finish(struct part_area *area); /* Frees it; zeroed is fine. */

#endif
