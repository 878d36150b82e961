/* The KMS backend: draws through GBM and EGL and shows buffers by page flips. Mesa finds the GPU
 * that renders for the card, so display node and render node may differ. */
#include "render/display/display_drm.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <errno.h>
#include <gbm.h>
#include <stdlib.h>

#include "base/log.h"
#include "render/display/context.h"
#include "render/display/display.h"
#include "render/display/driver.h"
#include "render/display/drm_buffer.h"
#include "render/display/drm_panel.h"
#include "render/display/fences.h"
#include "render/display/gl.h"

struct drm_display {
	struct drm_panel panel;
	struct gbm_device *gbm;
	struct gbm_surface *surface;
	EGLDisplay egl;
	EGLContext context;
	EGLSurface egl_surface;
	struct gbm_bo *shown, *next; /* borrowed from the surface until released */
};

static int create_context(struct drm_display *drm)
{
	EGLConfig config;

	drm->egl = eglGetPlatformDisplay(EGL_PLATFORM_GBM_KHR, drm->gbm, NULL);
	if (drm->egl == EGL_NO_DISPLAY || !eglInitialize(drm->egl, NULL, NULL))
		return -ENODEV;
	eglBindAPI(EGL_OPENGL_ES_API);
	/* A processor enlarges and copies pictures several times faster into a surface without
	 * depth (gl_draw_square). */
	config = context_config(drm->egl, GBM_FORMAT_XRGB8888,
				driver_is_software(drm->egl) ? 0 : 24);
	if (!config)
		return -ENODEV;
	drm->context = context_create(drm->egl, config);
	drm->egl_surface = eglCreatePlatformWindowSurface(drm->egl, config, drm->surface, NULL);
	if (drm->context == EGL_NO_CONTEXT || drm->egl_surface == EGL_NO_SURFACE ||
	    !eglMakeCurrent(drm->egl, drm->egl_surface, drm->egl_surface, drm->context))
		return -ENODEV;
	return 0;
}

static int create(struct display *display, const struct display_options *options)
{
	struct drm_display *drm = calloc(1, sizeof(*drm));
	int rc;

	if (!drm)
		return -ENOMEM;
	display->state = drm;
	rc = drm_panel_open(&drm->panel,
			    &(struct drm_card_options){
				    .device = options->device,
				    .connector = options->connector,
				    .mode = { options->width_px, options->height_px, options->hz },
				    .may_wait = options->kind == DISPLAY_DRM,
			    });
	if (rc < 0)
		return rc;
	drm->gbm = gbm_create_device(drm->panel.card.fd);
	if (drm->gbm)
		drm->surface = drm_buffer_surface(&drm->panel.card, drm->gbm);
	rc = drm->surface ? create_context(drm) : -ENODEV;
	if (rc < 0) {
		log_error("render", "board bug: no GLES2 context on the card (%s, EGL 0x%x)",
			  drm->gbm ? gbm_device_get_backend_name(drm->gbm) : "no GBM",
			  (unsigned)eglGetError());
		return rc;
	}
	display->width_px = drm->panel.card.mode.hdisplay;
	display->height_px = drm->panel.card.mode.vdisplay;
	display->width_mm = drm->panel.card.width_mm;
	if (drm->panel.card.mode.vrefresh > 0)
		display->refresh_us = 1000000 / drm->panel.card.mode.vrefresh;
	display->fd = drm_panel_fd(&drm->panel);
	return 0;
}

static void destroy(struct display *display)
{
	struct drm_display *drm = display->state;

	if (!drm)
		return;
	if (drm->egl != EGL_NO_DISPLAY) {
		fences_end();
		eglMakeCurrent(drm->egl, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
		if (drm->egl_surface != EGL_NO_SURFACE)
			eglDestroySurface(drm->egl, drm->egl_surface);
		if (drm->context != EGL_NO_CONTEXT)
			eglDestroyContext(drm->egl, drm->context);
		eglTerminate(drm->egl);
	}
	if (drm->shown)
		gbm_surface_release_buffer(drm->surface, drm->shown);
	if (drm->next)
		gbm_surface_release_buffer(drm->surface, drm->next);
	if (drm->surface)
		gbm_surface_destroy(drm->surface);
	if (drm->gbm)
		gbm_device_destroy(drm->gbm);
	drm_panel_close(&drm->panel);
	free(drm);
	display->state = NULL;
}

static int dispatch(struct display *display)
{
	struct drm_display *drm = display->state;
	bool flipped;
	const int rc = drm_panel_dispatch(&drm->panel, &flipped);

	if (flipped) {
		if (drm->shown)
			gbm_surface_release_buffer(drm->surface, drm->shown);
		drm->shown = drm->next;
		drm->next = NULL;
	}
	return rc;
}

static void begin(struct display *display)
{
	(void)display;
	gl_bind_framebuffer(0); /* the default framebuffer of the surface */
}

static int present(struct display *display)
{
	struct drm_display *drm = display->state;
	bool shown = false;
	uint32_t fb;
	int rc;

	fences_add();
	if (!eglSwapBuffers(drm->egl, drm->egl_surface))
		return eglGetError() == EGL_CONTEXT_LOST ? -ENOTRECOVERABLE : -EIO;
	drm->next = gbm_surface_lock_front_buffer(drm->surface);
	if (!drm->next)
		return -EIO;
	fb = drm_buffer_framebuffer(&drm->panel.card, drm->next);
	if (!fb)
		log_error("render", "board bug: the card refuses the buffer of a picture");
	rc = fb ? drm_panel_show(&drm->panel, fb, &shown) : -EIO;
	if (!shown) {
		gbm_surface_release_buffer(drm->surface, drm->next);
		drm->next = NULL;
	}
	return rc;
}

static bool is_ready(const struct display *display)
{
	const struct drm_display *drm = display->state;

	return drm_panel_ready(&drm->panel);
}

static bool is_dark(const struct display *display)
{
	const struct drm_display *drm = display->state;

	return drm_panel_dark(&drm->panel);
}

static int wait_ms(const struct display *display)
{
	const struct drm_display *drm = display->state;

	return drm_panel_wait_ms(&drm->panel);
}

static bool take_stale(struct display *display)
{
	struct drm_display *drm = display->state;

	return drm_panel_take_stale(&drm->panel);
}

static int sleep_or_wake(struct display *display, bool asleep)
{
	struct drm_display *drm = display->state;

	return drm_panel_sleep(&drm->panel, asleep);
}

const struct display_backend display_drm = {
	.name = "KMS",
	.create = create,
	.destroy = destroy,
	.dispatch = dispatch,
	.begin = begin,
	.present = present,
	.ready = is_ready,
	.dark = is_dark,
	.wait_ms = wait_ms,
	.take_stale = take_stale,
	.sleep = sleep_or_wake,
};
