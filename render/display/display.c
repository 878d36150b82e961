/* Chooses a backend (KMS, window or headless) and forwards every call to it. */
#include "render/display/display.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "render/display/display_backend.h"
#include "render/display/display_drm.h"
#include "render/display/display_headless.h"
#include "render/display/display_window.h"
#include "render/display/gl.h"

static int try_backend(struct display *display, const struct display_backend *backend,
		       const struct display_options *options)
{
	int rc;

	*display = (struct display){ .backend = backend, .fd = -1 };
	rc = backend->create(display, options);
	if (rc < 0) {
		backend->destroy(display);
		display->backend = NULL;
		return rc;
	}
	log_info("render", "%s display, %d x %d", backend->name, display->width_px,
		 display->height_px);
	return 0;
}

static int try_window(struct display *display, const struct display_options *options)
{
#ifdef GOPURA_NO_WINDOW
	(void)display;
	(void)options;
	log_error("render", "this kiosk was built without the window display; use --display drm");
	return -ENOTSUP;
#else
	return try_backend(display, &display_window, options);
#endif
}

static int try_any(struct display *display, const struct display_options *options)
{
	const bool desktop = getenv("DISPLAY") || getenv("WAYLAND_DISPLAY");
	int rc;

	/* In a desktop session another program owns the card, so a window is tried first. */
	if (desktop && try_window(display, options) == 0)
		return 0;
	rc = try_backend(display, &display_drm, options);
	if (rc < 0)
		rc = try_backend(display, &display_headless, options);
	return rc;
}

int display_create(struct display **out, const struct display_options *options)
{
	struct display *display = calloc(1, sizeof(*display));
	int rc = -EINVAL;

	*out = NULL;
	if (!display)
		return -ENOMEM;
	switch (options->kind) {
	case DISPLAY_AUTO:
		rc = try_any(display, options);
		break;
	case DISPLAY_DRM:
		rc = try_backend(display, &display_drm, options);
		break;
	case DISPLAY_WINDOW:
		rc = try_window(display, options);
		break;
	case DISPLAY_HEADLESS:
		rc = try_backend(display, &display_headless, options);
		break;
	}
	if (rc < 0) {
		free(display);
		return rc;
	}
	*out = display;
	return 0;
}

void display_destroy(struct display *display)
{
	if (!display)
		return;
	if (display->backend)
		display->backend->destroy(display);
	free(display);
}

enum display_kind display_kind(const struct display *display)
{
	return display->backend == &display_drm        ? DISPLAY_DRM
	       : display->backend == &display_headless ? DISPLAY_HEADLESS
						       : DISPLAY_WINDOW;
}

int display_width_px(const struct display *display)
{
	return display->width_px;
}

int display_height_px(const struct display *display)
{
	return display->height_px;
}

int display_width_mm(const struct display *display)
{
	return display->width_mm;
}

uint32_t display_refresh_us(const struct display *display)
{
	return display->refresh_us;
}

int display_fd(const struct display *display)
{
	return display->fd;
}

int display_wait_ms(const struct display *display)
{
	return display->backend->wait_ms ? display->backend->wait_ms(display) : -1;
}

int display_dispatch(struct display *display)
{
	return display->backend->dispatch ? display->backend->dispatch(display) : 0;
}

bool display_ready(const struct display *display)
{
	return !display->asleep && (!display->backend->ready || display->backend->ready(display));
}

bool display_is_dark(const struct display *display)
{
	return display->asleep || (display->backend->dark && display->backend->dark(display));
}

bool display_take_stale(struct display *display)
{
	const bool woken = display->woken;

	display->woken = false;
	return (display->backend->take_stale && display->backend->take_stale(display)) || woken;
}

/* Draws a panel black that cannot be switched off. */
static int show_black(struct display *display, int why)
{
	log_warn("render",
		 "board bug: the panel cannot be turned off (%s); it is made black instead",
		 strerror(-why));
	display_begin(display);
	glClearColor(0, 0, 0, 1);
	glClear(GL_COLOR_BUFFER_BIT);
	return display_present(display);
}

int display_sleep(struct display *display, bool asleep)
{
	int rc = 0;

	if (asleep == display->asleep)
		return 0;
	if (display->backend->sleep)
		rc = display->backend->sleep(display, asleep);
	if (asleep && rc < 0)
		rc = show_black(display, rc);
	display->asleep = asleep;
	display->woken = !asleep;
	return rc;
}

void display_begin(struct display *display)
{
	display->backend->begin(display);
}

int display_present(struct display *display)
{
	return display->backend->present(display);
}

int display_read(struct display *display, uint8_t *rgba)
{
	const size_t row = (size_t)display->width_px * 4;
	uint8_t *spare = malloc(row);

	if (!spare)
		return -ENOMEM;
	display_begin(display);
	glPixelStorei(GL_PACK_ALIGNMENT, 1);
	glReadPixels(0, 0, display->width_px, display->height_px, GL_RGBA, GL_UNSIGNED_BYTE, rgba);
	for (int low = 0, high = display->height_px - 1; low < high; low++, high--) {
		memcpy(spare, rgba + low * row, row);
		memcpy(rgba + low * row, rgba + high * row, row);
		memcpy(rgba + high * row, spare, row);
	}
	free(spare);
	return gl_check("reading a frame");
}
