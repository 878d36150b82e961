/* What the mirrors of the scenery show: the scan and the sky around them. Private to render/scene.
 */
#ifndef GOPURA_RENDER_SCENE_SCENE_AROUND_H
#define GOPURA_RENDER_SCENE_SCENE_AROUND_H

#include "render/scene/scene_parts.h"

enum { SCENE_AROUND_PX = 64 /* a side of a face */ };

/* Where shown scenery has mirrors, and the patches have changed since, draws a face of what they
 * will show: at rest, and before the scenery appears. What they show changes with the sixth.
 * Another framebuffer may be bound afterwards. */
void scene_update_around(struct scene *scene, bool moved);
/* Returns whether a face is still to be drawn. */
bool scene_around_waits(const struct scene *scene);
/* Frees the faces that were drawn. */
void scene_drop_around(struct scene *scene);

#endif
