/* Decides what the scene shows, in the order of a frame: decoded objects, the cut, the pieces in
 * the frustum, and the faces that colour them. Private to render/scene. */
#ifndef GOPURA_RENDER_SCENE_SCENE_PLAN_H
#define GOPURA_RENDER_SCENE_SCENE_PLAN_H

#include "render/scene/scene_parts.h"

/* Takes decoded objects until until_us. */
void scene_upload(struct scene *scene, int64_t until_us, struct scene_frame *out);
/* Drops groups over the budget, updates the cut and steps the dissolve. */
void scene_update_cut(struct scene *scene, float passed_ms);
/* After the visibility pass: computes which groups are desired. */
void scene_desire(struct scene *scene);
/* Lists the pieces in the frustum, front to back. */
void scene_list_pieces(struct scene *scene);
/* Plans pieces that need it, for at most budget_us. */
void scene_plan_pieces(struct scene *scene, int64_t budget_us);
/* Moves the weights of the blends towards what was chosen. */
void scene_fade_blends(struct scene *scene, float passed_ms);
/* Returns whether the shown surface leaves the sight between a sampling point and a point of itself
 * free. */
bool scene_sees(const struct scene *scene, const float sample_m[3], const float point_m[3]);
/* Returns the geometric error of a patch against the scan, metres. */
float scene_patch_error_m(const struct scene *scene, uint32_t patch);

#endif
