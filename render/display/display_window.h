/* The display in a window, for development. Private to render/display/display*.c. */
#ifndef GOPURA_RENDER_DISPLAY_DISPLAY_WINDOW_H
#define GOPURA_RENDER_DISPLAY_DISPLAY_WINDOW_H

#include "render/display/display_backend.h"

extern const struct display_backend display_window;

#endif
