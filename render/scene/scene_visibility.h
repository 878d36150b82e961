/* Runs the visibility pass of the scene. Private to render/scene. */
#ifndef GOPURA_RENDER_SCENE_SCENE_VISIBILITY_H
#define GOPURA_RENDER_SCENE_SCENE_VISIBILITY_H

#include "render/scene/scene_parts.h"

/* Runs a visibility pass where one is due, or half of one while the eye moves.
 * Returns whether anything was drawn for it. */
bool scene_take_visibility(struct scene *scene, bool moved);

#endif
