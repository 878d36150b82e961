/* Runs the visibility pass of the scene. Private to render/scene. */
#ifndef GOPURA_RENDER_SCENE_SCENE_VISIBILITY_H
#define GOPURA_RENDER_SCENE_SCENE_VISIBILITY_H

#include "render/scene/scene_parts.h"

/* Runs a visibility pass where one is due, or half of one while the eye moves.
 * Returns whether anything was drawn for it. */
bool scene_take_visibility(struct scene *scene, bool moved);

/* The same in steps. Begins a pass of the listed pieces in the view of the frame, beside_m as
 * visibility_begin has it; false: without memory for it. */
bool scene_begin_visibility(struct scene *scene, float beside_m);
/* Copies the listed pieces to scene->counted alone, for a picture without a pass; false: without
 * memory for it. */
bool scene_keep_pieces(struct scene *scene);
/* Draws those of scene->counted from `from` to below `to`, in the pass's target. */
void scene_draw_numbers(struct scene *scene, uint32_t from, uint32_t to);
/* Returns how many pixels of the screen a listed piece is seen at: those that the last pass
 * counted, or of one that no pass has counted an estimate. */
float scene_seen_px(const struct piece_state *state, const struct visible_piece *v);
/* Counts what the pass that was read back shows: pixels of pieces and patches; moves probes. */
void scene_count_visibility(struct scene *scene);

#endif
