/* Which patches are shown, and which groups would improve the picture most (pure; no GL).
 *
 * A cut is a set of refined groups (format/hierarchy.h). It grows greedily: of all groups whose
 * dependencies are refined, the one with the largest error on the screen is refined next, until
 * every error is below error_px or the triangles are spent. Errors and spheres are saturated, so
 * the order never has to be undone. It is grown twice: over the groups that are loaded (shown),
 * and over all that show in the picture, with what they depend on (desired); what is desired and
 * not loaded is wanted. How much shows of what is not there yet is shared out from the coarser
 * patch that stands in for it. */
#ifndef GOPURA_RENDER_PATCHES_CUT_H
#define GOPURA_RENDER_PATCHES_CUT_H

#include "format/hierarchy.h"
#include "geometry/view.h"

struct cut_want {
	uint32_t group;
	float error_px; /* of the picture while it is not there */
	float seen_px;  /* of the picture that it mends */
};

struct cut {
	const struct hierarchy *hierarchy; /* borrowed */
	uint8_t *shown, *desired;          /* per group: refined. Owned, like all below. */
	uint32_t *patches;                 /* shown, front to back is not promised */
	uint32_t patch_count;
	uint32_t triangle_count; /* of those in sight */
	struct cut_want *wants;  /* what others depend on comes first */
	uint32_t want_count;
	/* Private: replaced patches by group, what shows of patches and groups, and the heap. */
	uint32_t *replaced_first, *replaced, *waiting, *heap_group;
	float *patch_px, *group_px, *heap_error;
	uint8_t *needed;
	uint32_t heap_count;
};

struct cut_options {
	float error_px;
	uint32_t triangle_budget;
};

/* The hierarchy must outlive the cut. -ENOMEM. */
must_check int cut_init(struct cut *cut, const struct hierarchy *hierarchy);
void cut_finish(struct cut *cut);

/* What is shown. loaded[group] is not zero where the group's geometry is there. Patches outside the
 * view are in the list too (they cast occlusion); they do not count as triangles. */
void cut_update(struct cut *cut, const struct view *view, const uint8_t *loaded,
		const struct cut_options *options);
/* What is desired and wanted, after cut_update. seen_px[patch]: pixels on which a shown patch was
 * found to show, below 0 where nobody looked; seen_px is NULL when nobody looked at all. */
void cut_desire(struct cut *cut, const struct view *view, const uint8_t *loaded,
		const float *seen_px, const struct cut_options *options);
/* Only the shown patches, as seen from a point in every direction: error in texels of a picture
 * with focal_px pixels a unit of tangent. Nothing is wanted. */
void cut_update_around(struct cut *cut, const float eye_m[3], float focal_px, const uint8_t *loaded,
		       const struct cut_options *options);

/* Error on the screen while the group is not refined, pixels; INFINITY inside its sphere. */
float cut_group_error_px(const struct hierarchy_group *group, const float eye_m[3], float focal_px);
/* The patches that a group replaces: the groups that hold them must be refined before it. */
const uint32_t *cut_replaced(const struct cut *cut, uint32_t group, uint32_t *count);
/* Whether a patch is among those shown. */
bool cut_shows(const struct cut *cut, uint32_t patch);
/* Whether a group replaces a patch of another. */
bool cut_depends(const struct cut *cut, uint32_t group, uint32_t on_group);

#endif
