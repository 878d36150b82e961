/* Draws the depth maps of faces. Private to render/scene. */
#ifndef GOPURA_RENDER_SCENE_SCENE_DRAW_H
#define GOPURA_RENDER_SCENE_SCENE_DRAW_H

#include "render/scene/scene_parts.h"

/* Draws missing depth maps until until_us, then at most one outdated one. */
void scene_draw_depth(struct scene *scene, int64_t until_us, struct scene_frame *out);

#endif
