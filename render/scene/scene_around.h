/* What the mirrors of the scenery show: the scan and the sky around them. Private to render/scene.
 */
#ifndef GOPURA_RENDER_SCENE_SCENE_AROUND_H
#define GOPURA_RENDER_SCENE_SCENE_AROUND_H

#include "render/scene/scene_parts.h"

enum { SCENE_AROUND_PX = 64 /* a side of a face */ };

/* Draws the six faces where scenery has mirrors, and no eye moves, and the patches have changed
 * since. Returns whether it did; another framebuffer is bound then. */
bool scene_update_around(struct scene *scene, bool moved);

#endif
