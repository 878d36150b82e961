/* Lists what the scene wants. Private to render/scene. */
#ifndef GOPURA_RENDER_SCENE_SCENE_WANTS_H
#define GOPURA_RENDER_SCENE_SCENE_WANTS_H

#include "render/scene/scene_parts.h"

/* Rebuilds scene->wants, most wanted first. */
void scene_list_wants(struct scene *scene);

#endif
