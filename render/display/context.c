/* Asks EGL for a context with reset notification, and the GL robustness extensions for its
 * state. */
#include "render/display/context.h"

#include <stdlib.h>
#include <string.h>

#include <EGL/eglext.h>

#include "render/display/gl.h"

/* A driver may have hundreds, those of more than 8 bits a channel before all others. */
static EGLConfig config_with(EGLDisplay egl, EGLint visual, int depth_bits)
{
	const EGLint wanted[] = { EGL_SURFACE_TYPE,
				  EGL_WINDOW_BIT,
				  EGL_RENDERABLE_TYPE,
				  EGL_OPENGL_ES2_BIT,
				  EGL_RED_SIZE,
				  8,
				  EGL_GREEN_SIZE,
				  8,
				  EGL_BLUE_SIZE,
				  8,
				  EGL_DEPTH_SIZE,
				  depth_bits,
				  EGL_NONE };
	EGLConfig *all, found = NULL;
	EGLint count = 0, its_visual;

	if (!eglChooseConfig(egl, wanted, NULL, 0, &count) || count == 0)
		return NULL;
	all = calloc((size_t)count, sizeof(*all));
	if (!all || !eglChooseConfig(egl, wanted, all, count, &count))
		count = 0;
	for (EGLint i = 0; i < count && !found; i++)
		if (eglGetConfigAttrib(egl, all[i], EGL_NATIVE_VISUAL_ID, &its_visual) &&
		    its_visual == visual)
			found = all[i];
	free(all);
	return found;
}

EGLConfig context_config(EGLDisplay egl, EGLint visual, int depth_bits)
{
	static const int fewer[] = { 24, 16, 0 };
	EGLConfig found = NULL;

	for (size_t i = 0; i < ARRAY_COUNT(fewer) && !found; i++)
		if (fewer[i] <= depth_bits)
			found = config_with(egl, visual, fewer[i]);
	return found;
}

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
