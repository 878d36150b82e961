/* Asks EGL for a context with reset notification, and the GL robustness extensions for its
 * state. */
#include "render/display/context.h"

#include <string.h>

#include <EGL/eglext.h>

#include "render/display/gl.h"

EGLContext context_create(EGLDisplay egl, EGLConfig config)
{
	static const EGLint plain[] = { EGL_CONTEXT_CLIENT_VERSION, 2, EGL_NONE };
	/* Notification of resets only, without the bounds checks of every access that "robust
	 * access" would add. */
	static const EGLint telling[] = { EGL_CONTEXT_CLIENT_VERSION, 2,
					  EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY_EXT,
					  EGL_LOSE_CONTEXT_ON_RESET_EXT, EGL_NONE };
	const char *all = eglQueryString(egl, EGL_EXTENSIONS);
	EGLContext context = EGL_NO_CONTEXT;

	if (all && strstr(all, "EGL_EXT_create_context_robustness"))
		context = eglCreateContext(egl, config, EGL_NO_CONTEXT, telling);
	return context != EGL_NO_CONTEXT ? context
					 : eglCreateContext(egl, config, EGL_NO_CONTEXT, plain);
}

static PFNGLGETGRAPHICSRESETSTATUSEXTPROC reset_status(void)
{
	const char *name = NULL;

	if (gl_has_extension("GL_EXT_robustness"))
		name = "glGetGraphicsResetStatusEXT";
	else if (gl_has_extension("GL_KHR_robustness"))
		name = "glGetGraphicsResetStatusKHR";
	return name ? (PFNGLGETGRAPHICSRESETSTATUSEXTPROC)eglGetProcAddress(name) : NULL;
}

bool context_is_lost(void)
{
	static PFNGLGETGRAPHICSRESETSTATUSEXTPROC status;
	static bool asked;

	if (!asked) {
		status = reset_status();
		asked = true;
	}
	return status && status() != GL_NO_ERROR;
}
