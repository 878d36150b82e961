/* The streaming mesh in the scene: it is shown until the patches that take its place are here, and
 * dissolves into them. Private to render/scene. */
#ifndef GOPURA_RENDER_SCENE_SCENE_STREAM_H
#define GOPURA_RENDER_SCENE_SCENE_STREAM_H

#include "render/scene/scene_parts.h"

/* Returns how many first groups of the hierarchy take its place; the hierarchy must be here. */
uint32_t scene_first_cut(const struct scene *scene);
/* Returns whether these groups are loaded. */
bool scene_first_cut_is_here(const struct scene *scene);
/* Grows what is shown, uploads it, and decides how the root group appears. Comes before the step of
 * the dissolve. */
void scene_step_stream(struct scene *scene, float passed_ms);
/* Draws it where the root group does not cover it. */
void scene_draw_stream(struct scene *scene, const struct surface_frame *frame);
/* Frees it. */
void scene_drop_stream(struct scene *scene);

#endif
