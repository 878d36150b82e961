/* What a board's profile asks of the scene. */
#ifndef GOPURA_APP_SETTINGS_SCENE_SETTINGS_H
#define GOPURA_APP_SETTINGS_SCENE_SETTINGS_H

#include "board/profile.h"
#include "render/scene/scene.h"

/* Returns the options of a scene on that board. */
struct scene_options scene_settings(const struct profile *profile, enum scene_mode mode);

#endif
