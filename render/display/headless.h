/* A GLES2 context without a display: on EGL's surfaceless platform where Mesa offers it, else on an
 * EGL device. Pictures are drawn into a gl_target (render/display/gl.h). */
#ifndef GOPURA_RENDER_DISPLAY_HEADLESS_H
#define GOPURA_RENDER_DISPLAY_HEADLESS_H

#include "base/compiler.h"
#include "render/display/gl.h"

struct headless;

/* Creates a context and makes it current on the calling thread, which must also destroy it. The
 * caller owns *out; it is NULL on failure, which is logged. -ENODEV: no platform offers a GLES2
 * context. -ENOMEM. */
must_check int headless_create(struct headless **out);
/* Creates a target like the panel that such a driver would have: without depth if it draws on the
 * processor (display_drm.c). As gl_target_create. */
must_check int headless_panel(const struct headless *headless, struct gl_target *out, int width_px,
			      int height_px);
/* Frees the context and all GL objects in it. NULL is fine. */
void headless_destroy(struct headless *headless);

#endif
