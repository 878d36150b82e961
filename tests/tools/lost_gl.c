/* Simulates a GPU reset: preloaded (LD_PRELOAD) before EGL and GLES2. As soon as the file named by
 * LOST_GL exists, the context is lost. LOST_GL_BY names how the driver reports it, since drivers
 * differ:
 *
 *   status  glGetGraphicsResetStatus (as a driver with robustness does)
 *   error   glGetError returns GL_CONTEXT_LOST from then on
 *   swap    eglSwapBuffers fails with EGL_CONTEXT_LOST
 */
#include <dlfcn.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <EGL/egl.h>
#include <GLES2/gl2.h>
#include <GLES2/gl2ext.h>

#define REAL(name) ((__typeof__(&(name)))dlsym(RTLD_NEXT, #name))

static bool lost_by(const char *way)
{
	const char *file = getenv("LOST_GL"), *by = getenv("LOST_GL_BY");

	return file && by && strcmp(by, way) == 0 && access(file, F_OK) == 0;
}

static GLenum GL_APIENTRY status(void)
{
	return lost_by("status") ? GL_UNKNOWN_CONTEXT_RESET_EXT : GL_NO_ERROR;
}

EGLAPI __eglMustCastToProperFunctionPointerType EGLAPIENTRY eglGetProcAddress(const char *name)
{
	if (strncmp(name, "glGetGraphicsResetStatus", 24) == 0)
		return (__eglMustCastToProperFunctionPointerType)status;
	return REAL(eglGetProcAddress)(name);
}

GL_APICALL GLenum GL_APIENTRY glGetError(void)
{
	return lost_by("error") ? GL_CONTEXT_LOST_KHR : REAL(glGetError)();
}

static bool swap_failed;

EGLAPI EGLBoolean EGLAPIENTRY eglSwapBuffers(EGLDisplay display, EGLSurface surface)
{
	swap_failed = lost_by("swap");
	return swap_failed ? EGL_FALSE : REAL(eglSwapBuffers)(display, surface);
}

EGLAPI EGLint EGLAPIENTRY eglGetError(void)
{
	return swap_failed ? EGL_CONTEXT_LOST : REAL(eglGetError)();
}
