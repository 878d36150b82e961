/* Chooses which patches are shown, and which groups would improve the picture most. Pure; no GL.
 *
 * A cut is a set of refined groups (format/hierarchy.h). It grows greedily: among all groups whose
 * dependencies are refined, the one with the largest error on the screen is refined next, until
 * every error is below error_px or the triangle budget is spent. Errors and spheres are saturated,
 * so the order never has to be undone. The cut is grown twice: over the groups that are loaded (the
 * result is shown), and over all groups that are visible in the picture together with their
 * dependencies (the result is desired). A group that is desired but not loaded is wanted. The
 * visible area of a patch that is not loaded is estimated: it gets a share of the area of the
 * coarser patch that stands in for it. */
#ifndef GOPURA_RENDER_PATCHES_CUT_H
#define GOPURA_RENDER_PATCHES_CUT_H

#include "format/hierarchy.h"
#include "geometry/view.h"

struct cut_want {
	uint32_t group;
	float error_px; /* its error on the screen while it is not refined */
	float seen_px;  /* pixels of the picture that it would improve */
};

struct cut {
	const struct hierarchy *hierarchy; /* borrowed */
	uint8_t *shown, *desired;          /* per group: 1 if refined. Owned, like all below. */
	uint32_t *patches;                 /* the shown patches, in no particular order */
	uint32_t patch_count;
	uint32_t triangle_count; /* of the shown patches inside the view */
	struct cut_want *wants;  /* a group comes after those it depends on */
	uint32_t want_count;
	/* Private: the replaced patches of each group, the visible pixels of patches and groups,
	 * and the heap. */
	uint32_t *replaced_first, *replaced, *waiting, *heap_group;
	float *patch_px, *group_px, *heap_error;
	uint8_t *needed;
	uint32_t heap_count;
};

struct cut_options {
	float error_px;
	uint32_t triangle_budget;
};

/* Initialises a cut. The hierarchy is borrowed and must outlive it. Returns 0 or -ENOMEM. */
must_check int cut_init(struct cut *cut, const struct hierarchy *hierarchy);
/* Frees what it owns. */
void cut_finish(struct cut *cut);

/* Computes what is shown. loaded[group] is nonzero where the group's geometry is in memory. The
 * list includes patches outside the view, because they occlude in the depth maps of sampling
 * points; they do not count as triangles. */
void cut_update(struct cut *cut, const struct view *view, const uint8_t *loaded,
		const struct cut_options *options);
/* Computes what is desired and wanted; call it after cut_update. seen_px[patch] is the number of
 * pixels on which a shown patch was found visible, negative where it was not counted. seen_px is
 * NULL where nothing was counted. */
void cut_desire(struct cut *cut, const struct view *view, const uint8_t *loaded,
		const float *seen_px, const struct cut_options *options);
/* Computes only the shown patches, for a viewpoint that sees in all directions; the error is in
 * texels of a picture with focal_px pixels per unit of tangent. Nothing becomes wanted. */
void cut_update_around(struct cut *cut, const float eye_m[3], float focal_px, const uint8_t *loaded,
		       const struct cut_options *options);

/* Returns the error on the screen in pixels while the group is not refined. Inside its sphere it is
 * that of a surface a tenth of a millimetre away: beyond every limit, but a larger error in metres
 * still comes first when triangles are short. INFINITY for group 0. */
float cut_group_error_px(const struct hierarchy_group *group, const float eye_m[3], float focal_px);
/* Returns the patches that a group replaces, borrowed. The groups that hold them must be refined
 * before it. */
const uint32_t *cut_replaced(const struct cut *cut, uint32_t group, uint32_t *count);
/* Returns whether a patch is among those shown. */
bool cut_shows(const struct cut *cut, uint32_t patch);
/* Returns whether a group replaces a patch of another group. */
bool cut_depends(const struct cut *cut, uint32_t group, uint32_t on_group);

#endif
