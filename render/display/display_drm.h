/* The display on a KMS panel. Private to render/display/display*.c. */
#ifndef GOPURA_RENDER_DISPLAY_DISPLAY_DRM_H
#define GOPURA_RENDER_DISPLAY_DISPLAY_DRM_H

#include "render/display/display_backend.h"

extern const struct display_backend display_drm;

#endif
