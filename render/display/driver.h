/* What an EGL display draws with. */
#ifndef GOPURA_RENDER_DISPLAY_DRIVER_H
#define GOPURA_RENDER_DISPLAY_DRIVER_H

#include <stdbool.h>

#include <EGL/egl.h>

/* Returns whether the display's driver draws on the processor, with Mesa's llvmpipe or softpipe;
 * false also where EGL cannot tell. The display is initialized. */
bool driver_is_software(EGLDisplay egl);

#endif
