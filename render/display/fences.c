/* A ring of the last fences. */
#include "render/display/fences.h"

#include <stdbool.h>
#include <string.h>

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include "render/display/driver.h"

enum { KEPT = 8 };

static struct {
	bool looked; /* whether there are any */
	EGLDisplay display;
	PFNEGLCREATESYNCKHRPROC create; /* NULL: there are none */
	PFNEGLDESTROYSYNCKHRPROC destroy;
	PFNEGLCLIENTWAITSYNCKHRPROC wait;
	EGLSyncKHR kept[KEPT]; /* number n is at n % KEPT */
	uint64_t last;
} fences;

static void look(void)
{
	const char *all;

	fences.looked = true;
	fences.display = eglGetCurrentDisplay();
	all = eglQueryString(fences.display, EGL_EXTENSIONS);
	if (!all || !strstr(all, "EGL_KHR_fence_sync") || !driver_is_software(fences.display))
		return;
	fences.destroy = (PFNEGLDESTROYSYNCKHRPROC)eglGetProcAddress("eglDestroySyncKHR");
	fences.wait = (PFNEGLCLIENTWAITSYNCKHRPROC)eglGetProcAddress("eglClientWaitSyncKHR");
	if (fences.destroy && fences.wait)
		fences.create = (PFNEGLCREATESYNCKHRPROC)eglGetProcAddress("eglCreateSyncKHR");
}

uint64_t fences_add(void)
{
	EGLSyncKHR *oldest = &fences.kept[(fences.last + 1) % KEPT], added;

	if (!fences.looked)
		look();
	added = fences.create ? fences.create(fences.display, EGL_SYNC_FENCE_KHR, NULL)
			      : EGL_NO_SYNC_KHR;
	if (added == EGL_NO_SYNC_KHR)
		return 0;
	if (fences.last >= KEPT) {
		fences_wait(fences.last + 2 - KEPT);
		fences.destroy(fences.display, *oldest);
	}
	*oldest = added;
	return ++fences.last;
}

void fences_wait(uint64_t number)
{
	if (number == 0)
		return;
	if (number + KEPT <= fences.last)
		number = fences.last + 1 - KEPT;
	fences.wait(fences.display, fences.kept[number % KEPT], EGL_SYNC_FLUSH_COMMANDS_BIT_KHR,
		    EGL_FOREVER_KHR);
}

void fences_end(void)
{
	for (uint64_t n = 0; n < KEPT && n < fences.last; n++)
		fences.destroy(fences.display, fences.kept[(fences.last - n) % KEPT]);
	memset(&fences, 0, sizeof(fences));
}
