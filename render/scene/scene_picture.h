/* Draws pictures of the scene: its pieces, the streaming mesh, what stands behind and beside.
 * Private to render/scene. */
#ifndef GOPURA_RENDER_SCENE_SCENE_PICTURE_H
#define GOPURA_RENDER_SCENE_SCENE_PICTURE_H

#include "render/scene/scene_parts.h"

/* Direct: in the caller's framebuffer; aside: in a target; shares: there, of the images. */
enum picture { PICTURE_DIRECT, PICTURE_ASIDE, PICTURE_SHARES };

/* Clears the bound target to the background. */
void scene_begin_picture(const struct scene *scene);
/* Draws the listed pieces, and what else is shown, as seen in a view. */
void scene_draw_picture(struct scene *scene, const struct view *view, enum picture kind);

#endif
