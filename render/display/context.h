/* A GLES2 context that says when the GPU lost it, where the driver can tell: after a reset, or a
 * driver that gave up. Nothing of such a context can be used again, so whoever has one ends, and
 * the program starts anew. For the thread that owns the context. */
#ifndef GOPURA_RENDER_DISPLAY_CONTEXT_H
#define GOPURA_RENDER_DISPLAY_CONTEXT_H

#include <stdbool.h>

#include <EGL/egl.h>

/* EGL_NO_CONTEXT on failure, as eglCreateContext. */
EGLContext context_create(EGLDisplay egl, EGLConfig config);
/* The current context is lost; false where the driver cannot say. */
bool context_is_lost(void);

#endif
