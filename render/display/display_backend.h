/* The interface that each kind of display implements; private to render/display/display*.c. */
#ifndef GOPURA_RENDER_DISPLAY_DISPLAY_BACKEND_H
#define GOPURA_RENDER_DISPLAY_DISPLAY_BACKEND_H

#include <stdbool.h>
#include <stdint.h>

struct display;
struct display_options;

struct display_backend {
	const char *name;
	/* Fills display->state; on failure destroy is called as well. */
	int (*create)(struct display *display, const struct display_options *options);
	void (*destroy)(struct display *display);
	int (*dispatch)(struct display *display);
	void (*begin)(struct display *display);
	int (*present)(struct display *display);
	/* These may be NULL where nothing is waited for; so may dispatch. */
	bool (*ready)(const struct display *display);
	bool (*dark)(const struct display *display);
	int (*wait_ms)(const struct display *display);
	bool (*take_stale)(struct display *display);
	int (*sleep)(struct display *display, bool asleep);
};

struct display {
	const struct display_backend *backend;
	void *state; /* the backend's own */
	int width_px, height_px, width_mm;
	uint32_t refresh_us; /* 0: not known */
	int fd;
	bool asleep, woken;
};

#endif
