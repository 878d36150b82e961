/* What a kind of display provides; private to render/display*.c. */
#ifndef GOPURA_RENDER_DISPLAY_BACKEND_H
#define GOPURA_RENDER_DISPLAY_BACKEND_H

#include <stdint.h>

#include "render/display.h"

struct display_backend {
	enum display_kind kind;
	const char *name;
	/* Fills display->state; on failure destroy is called as well. */
	int (*create)(struct display *display, const struct display_options *options);
	void (*destroy)(struct display *display);
	int (*dispatch)(struct display *display);
	void (*begin)(struct display *display);
	int (*present)(struct display *display);
};

struct display {
	const struct display_backend *backend;
	void *state; /* the backend's own */
	int width_px, height_px, width_mm;
	int fd;
	bool flip_pending;
	int64_t flip_asked_ms;
};

extern const struct display_backend display_drm, display_window, display_headless;

#endif
