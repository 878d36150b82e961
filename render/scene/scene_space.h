/* The space around the model in which an eye may be. */
#ifndef GOPURA_RENDER_SCENE_SCENE_SPACE_H
#define GOPURA_RENDER_SCENE_SCENE_SPACE_H

#include "render/scene/scene_parts.h"

/* Takes the octree of where an eye may be, and leaves an empty one. */
void scene_put_solid(struct scene *scene, struct solid *solid);

#endif
