/* Puts a fence after each part of the triangles, and waits for the one before. */
#include "render/display/throttle.h"

#include <string.h>

#include "base/compiler.h"
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
	for (size_t i = 0; i < ARRAY_COUNT(throttle->fences); i++)
		if (throttle->fences[i])
			throttle->destroy(throttle->display, throttle->fences[i]);
	memset(throttle, 0, sizeof(*throttle));
}

/* Each of llvmpipe's threads counts a fence up and then wakes those that wait. The fence is passed
 * before the last of them has done so, and freed by then it would be written to (Mesa 22.3). So one
 * is kept until the next has passed, which each thread comes to after it. */
void throttle_count(struct throttle *throttle, uint32_t triangles)
{
	EGLSyncKHR *const fences = throttle->fences;

	throttle->triangles += triangles;
	if (!throttle->create || throttle->triangles < PART_TRIANGLES)
		return;
	const EGLSyncKHR next = throttle->create(throttle->display, EGL_SYNC_FENCE_KHR, NULL);
	throttle->triangles = 0;
	glFlush();
	if (!next)
		return;
	if (fences[1])
		throttle->wait(throttle->display, fences[1], 0, EGL_FOREVER_KHR);
	if (fences[0])
		throttle->destroy(throttle->display, fences[0]);
	fences[0] = fences[1];
	fences[1] = next;
}
