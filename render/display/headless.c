/* Tries EGL's surfaceless platform and then each EGL device until one gives a GLES2 context. */
#include "render/display/headless.h"

#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include "base/log.h"
#include "render/display/context.h"
#include "render/display/driver.h"
#include "render/display/fences.h"

enum { DEVICES_MAX = 8 };

struct headless {
	EGLDisplay display;
	EGLContext context;
};

static bool has_client_extension(const char *name)
{
	const char *all = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);

	return all && strstr(all, name);
}

static bool start_context(struct headless *headless)
{
	/* no surface: we draw into textures */
	static const EGLint wanted[] = { EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE,
					 EGL_OPENGL_ES2_BIT, EGL_NONE };
	EGLConfig config;
	EGLint count = 0;

	if (!eglInitialize(headless->display, NULL, NULL))
		return false;
	if (eglBindAPI(EGL_OPENGL_ES_API) &&
	    eglChooseConfig(headless->display, wanted, &config, 1, &count) && count == 1) {
		headless->context = context_create(headless->display, config);
		if (headless->context != EGL_NO_CONTEXT &&
		    eglMakeCurrent(headless->display, EGL_NO_SURFACE, EGL_NO_SURFACE,
				   headless->context))
			return true;
	}
	eglTerminate(headless->display);
	return false;
}

static bool try_platform(struct headless *headless, EGLenum platform, void *native)
{
	PFNEGLGETPLATFORMDISPLAYEXTPROC get =
		(PFNEGLGETPLATFORMDISPLAYEXTPROC)eglGetProcAddress("eglGetPlatformDisplayEXT");

	if (!get)
		return false;
	headless->display = get(platform, native, NULL);
	return headless->display != EGL_NO_DISPLAY && start_context(headless);
}

static bool try_devices(struct headless *headless)
{
	PFNEGLQUERYDEVICESEXTPROC query =
		(PFNEGLQUERYDEVICESEXTPROC)eglGetProcAddress("eglQueryDevicesEXT");
	EGLDeviceEXT devices[DEVICES_MAX];
	EGLint count = 0;

	if (!query || !query(DEVICES_MAX, devices, &count))
		return false;
	for (EGLint i = 0; i < count; i++)
		if (try_platform(headless, EGL_PLATFORM_DEVICE_EXT, devices[i]))
			return true;
	return false;
}

int headless_create(struct headless **out)
{
	struct headless *headless = calloc(1, sizeof(*headless));

	*out = NULL;
	if (!headless)
		return -ENOMEM;
	if (has_client_extension("EGL_MESA_platform_surfaceless") &&
	    try_platform(headless, EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY))
		goto done;
	if (has_client_extension("EGL_EXT_platform_device") && try_devices(headless))
		goto done;
	log_error("render", "no GLES2 without a display: neither EGL's surfaceless platform nor an "
			    "EGL device works (on Debian, install libgl1-mesa-dri)");
	free(headless);
	return -ENODEV;
done:
	*out = headless;
	return 0;
}

int headless_panel(const struct headless *headless, struct gl_target *out, int width_px,
		   int height_px)
{
	return driver_is_software(headless->display)
		       ? gl_target_create_flat(out, width_px, height_px)
		       : gl_target_create(out, width_px, height_px);
}

void headless_destroy(struct headless *headless)
{
	if (!headless)
		return;
	fences_end();
	eglMakeCurrent(headless->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
	eglDestroyContext(headless->display, headless->context);
	/* EGL shares one display between all contexts of the process; terminating it here would end
	 * the others. */
	eglReleaseThread();
	free(headless);
}
