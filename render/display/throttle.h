/* Keeps a driver that draws on the processor from getting far ahead of what is drawn. Mesa's
 * llvmpipe first sorts triangles into tiles, in hundreds of bytes each, and goes on sorting while
 * it draws: of a large picture everything but the beginning would wait in memory (docs/figures.md,
 * "Footprint"). On a GPU, and where EGL has no fences, everything here does nothing. */
#ifndef GOPURA_RENDER_DISPLAY_THROTTLE_H
#define GOPURA_RENDER_DISPLAY_THROTTLE_H

#include <stdint.h>

#include <EGL/egl.h>
#include <EGL/eglext.h>

struct throttle {
	PFNEGLCREATESYNCKHRPROC create; /* NULL: nothing is throttled */
	PFNEGLDESTROYSYNCKHRPROC destroy;
	PFNEGLCLIENTWAITSYNCKHRPROC wait;
	EGLDisplay display;   /* borrowed */
	EGLSyncKHR fences[2]; /* after the two parts before this one, the older first */
	uint32_t triangles;   /* of this part */
};

/* Looks at the current context, which must outlive it. */
void throttle_init(struct throttle *throttle);
void throttle_finish(struct throttle *throttle); /* zeroed is fine */
/* Tells that so many triangles were drawn. Where they complete a part, waits until the part before
 * it is drawn, so that at most two are under way: one is sorted while the other is drawn. */
void throttle_count(struct throttle *throttle, uint32_t triangles);

#endif
