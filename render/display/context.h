/* Creates GLES2 contexts that report when the GPU has lost them, after a reset or a driver failure,
 * where the driver can tell. No object of a lost context can be used again, so the program ends and
 * is started again. Call it on the thread that owns the context. */
#ifndef GOPURA_RENDER_DISPLAY_CONTEXT_H
#define GOPURA_RENDER_DISPLAY_CONTEXT_H

#include <stdbool.h>

#include <EGL/egl.h>

/* Returns the configuration of windows whose pixel format is that native visual, with as many bits
 * of depth as there are up to 24; 0: none are needed. NULL: there is no such configuration. */
EGLConfig context_config(EGLDisplay egl, EGLint visual, int depth_bits);
/* Returns a new GLES2 context, owned by the caller, or EGL_NO_CONTEXT like eglCreateContext. */
EGLContext context_create(EGLDisplay egl, EGLConfig config);
/* Returns whether the current context is lost; false also where the driver cannot tell. */
bool context_is_lost(void);

#endif
