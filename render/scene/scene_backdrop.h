/* The first view of a new terminal: while the eye is at a vantage point and the mesh is not as fine
 * as it shall be, the point's images are shown as they are. Private to render/scene. */
#ifndef GOPURA_RENDER_SCENE_SCENE_BACKDROP_H
#define GOPURA_RENDER_SCENE_SCENE_BACKDROP_H

#include "render/scene/scene_parts.h"

/* Decides what is shown and wanted, and marks its tiles as in use; after scene_fade_blends. */
void scene_step_backdrop(struct scene *scene, float passed_ms);
/* Returns what an image of the level is worth to a look, where one of the level before is shown;
 * -1: none. On the scale of plan_worth. */
float scene_backdrop_worth(const struct scene *scene, int level, int before);
/* Returns whether all else waits for it, because it is about to show half of the screen's detail; a
 * few seconds at most. */
bool scene_awaits_backdrop(const struct scene *scene);
/* Draws it over the model, whose depths stay. */
void scene_draw_backdrop(struct scene *scene, const struct view *view);

#endif
