/* Marks a part in the picture of the scene. Private to render/scene. */
#ifndef GOPURA_RENDER_SCENE_SCENE_MARK_H
#define GOPURA_RENDER_SCENE_SCENE_MARK_H

#include "render/scene/scene_parts.h"

/* Stores what is marked (NULL: nothing). Returns whether it differs from the frame
 * before. */
bool scene_note_mark(struct scene *scene, const struct scene_mark *mark);
/* Draws the mask of the marked part for a picture that was just drawn, for outline_draw; binds
 * another framebuffer. */
void scene_draw_mask(struct scene *scene, const struct view *view, const struct gl_target *picture);

#endif
