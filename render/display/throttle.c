/* Puts a fence after each part of the triangles, and waits for the one before. */
#include "render/display/throttle.h"

#include <string.h>

#include "render/display/context.h"
#include "render/display/gl.h"

enum { PART_TRIANGLES = 2000 };

void throttle_init(struct throttle *throttle)
{
	memset(throttle, 0, sizeof(*throttle));
	throttle->display = eglGetCurrentDisplay();
	const char *all = eglQueryString(throttle->display, EGL_EXTENSIONS);
	if (!all || !strstr(all, "EGL_KHR_fence_sync") || !context_is_software(throttle->display))
		return;
	throttle->destroy = (PFNEGLDESTROYSYNCKHRPROC)eglGetProcAddress("eglDestroySyncKHR");
	throttle->wait = (PFNEGLCLIENTWAITSYNCKHRPROC)eglGetProcAddress("eglClientWaitSyncKHR");
	if (throttle->destroy && throttle->wait)
		throttle->create = (PFNEGLCREATESYNCKHRPROC)eglGetProcAddress("eglCreateSyncKHR");
}

void throttle_finish(struct throttle *throttle)
{
	if (throttle->fence)
		throttle->destroy(throttle->display, throttle->fence);
	memset(throttle, 0, sizeof(*throttle));
}

void throttle_count(struct throttle *throttle, uint32_t triangles)
{
	throttle->triangles += triangles;
	if (!throttle->create || throttle->triangles < PART_TRIANGLES)
		return;
	const EGLSyncKHR before = throttle->fence;
	throttle->triangles = 0;
	throttle->fence = throttle->create(throttle->display, EGL_SYNC_FENCE_KHR, NULL);
	glFlush();
	if (!before)
		return;
	throttle->wait(throttle->display, before, 0, EGL_FOREVER_KHR);
	throttle->destroy(throttle->display, before);
}
