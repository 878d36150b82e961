/* The display without a panel, in memory. Private to render/display/display*.c. */
#ifndef GOPURA_RENDER_DISPLAY_DISPLAY_HEADLESS_H
#define GOPURA_RENDER_DISPLAY_DISPLAY_HEADLESS_H

#include "render/display/display_backend.h"

extern const struct display_backend display_headless;

#endif
