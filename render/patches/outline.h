/* A part's outline on one patch, and what of the patch lies within, by its labels. Pure; places are
 * on the lattice. */
#ifndef GOPURA_RENDER_PATCHES_OUTLINE_H
#define GOPURA_RENDER_PATCHES_OUTLINE_H

#include "format/label.h"
#include "geometry/patch_bvh.h"

struct outline_line {
	float at[2][3];
	float normal[3]; /* of the triangle it lies on, unit */
};

struct outline {
	struct outline_line *lines; /* owned, like the next two */
	uint16_t *whole;            /* triangles that lie within: corners, as the solid's indices */
	float (*within)[3];         /* of the others what lies within: corners, three a triangle */
	uint32_t line_count, whole_count, within_count;
	uint32_t line_room, whole_room, within_room; /* private */
};

/* patch: within its group, of which the solid is. part: the group's number. *out is finished by the
 * caller. -ENOMEM. */
must_check int outline_create(struct outline *out, const struct patch_bvh *bvh,
			      const struct label_group *labels, uint32_t patch, uint32_t part);
void outline_finish(struct outline *outline); /* zeroed is fine */

#endif
