/* A GLES2 context without any display: EGL's surfaceless platform where Mesa offers it, else an EGL
 * device. Pictures are drawn into a gl_target (render/display/gl.h). */
#ifndef GOPURA_RENDER_DISPLAY_HEADLESS_H
#define GOPURA_RENDER_DISPLAY_HEADLESS_H

#include "base/compiler.h"

struct headless;

/* Makes the context current on the calling thread, to which it belongs until destroyed. *out is
 * NULL on failure, which is logged. -ENODEV: no platform gives a GLES2 context. */
must_check int headless_create(struct headless **out);
/* Frees the context and all GL objects in it. NULL is fine. */
void headless_destroy(struct headless *headless);

#endif
