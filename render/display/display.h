/* Where pictures appear: a KMS panel, a window for development, or memory. Creating a display makes
 * its GLES2 context current; all calls belong to the thread that created it.
 *
 * The rotation of a panel is applied in the projections (geometry/camera.h,
 * render/display/quads.h), never as a plane property, so that it works the same on every board. */
#ifndef GOPURA_RENDER_DISPLAY_DISPLAY_H
#define GOPURA_RENDER_DISPLAY_DISPLAY_H

#include <stdbool.h>
#include <stdint.h>

#include "base/compiler.h"

enum display_kind {
	DISPLAY_AUTO, /* a window in a desktop session, else a free KMS panel, else headless */
	DISPLAY_DRM,
	DISPLAY_WINDOW,
	DISPLAY_HEADLESS
};

enum pointer_kind { POINTER_MOVE, POINTER_DOWN, POINTER_UP, POINTER_WHEEL };

struct display_options {
	enum display_kind kind;
	int width_px, height_px; /* DRM: the mode to use, 0: the panel's preferred one */
	int hz;                  /* DRM: its rate, 0: any */
	const char *device;      /* DRM: borrowed for the call; NULL: the first card with a panel */
	const char *connector;   /* DRM: such as "HDMI-A-1"; NULL: the first that is connected */
	const char *title;       /* window: borrowed for the call */

	/* Window: the mouse acts as one finger. wheel_steps is positive away from the user. */
	void (*pointer)(void *data, enum pointer_kind kind, float x_px, float y_px,
			float wheel_steps);
	void (*closed)(void *data); /* window: called when its close button is pressed */
	void *data;
};

struct display;

/* Creates a display. The caller owns *out; it is NULL on failure. -ENODEV: no such display here
 * (the log says why). -ENOTSUP: built without a window. -ENOMEM. */
must_check int display_create(struct display **out, const struct display_options *options);
/* Frees the display and its GL context. NULL and a half-built display are fine. */
void display_destroy(struct display *display);

/* Returns what DISPLAY_AUTO turned out to be. */
enum display_kind display_kind(const struct display *display);
/* The width of the framebuffer in pixels, before rotation. */
int display_width_px(const struct display *display);
/* The height of the framebuffer in pixels, before rotation. */
int display_height_px(const struct display *display);
/* Returns the width of the visible area in millimetres, from the panel's EDID; 0: not known. */
int display_width_mm(const struct display *display);

/* Returns the time between two refreshes of the panel in microseconds; 0: not known. */
uint32_t display_refresh_us(const struct display *display);

/* Returns a descriptor, borrowed, that is readable when display_dispatch has work: a flip
 * completed, or the window has events. -1: there is none. */
int display_fd(const struct display *display);
/* Returns the milliseconds after which display_dispatch has work even if the descriptor is not
 * readable; -1: never. */
int display_wait_ms(const struct display *display);
/* Handles flips, hot-plug and window events. -ETIMEDOUT: a flip did not complete in time; the panel
 * or its driver hangs. -ESTALE: a panel of another size was plugged in; only a new process can use
 * it. Other negative errno: the card or the timer cannot be read. */
must_check int display_dispatch(struct display *display);

/* Returns whether a frame may be drawn now: the last one is on the panel. */
bool display_ready(const struct display *display);
/* Returns whether nothing can be shown although there is no fault: no panel is plugged in, it is
 * asleep, or another program uses it. */
bool display_is_dark(const struct display *display);
/* Returns whether a frame must be drawn although nothing changed, because the last one is not, or
 * no longer, on the panel. The call clears this state. */
bool display_take_stale(struct display *display);
/* Switches the panel off or on; off only where display_ready. -ESTALE as in display_dispatch. A
 * panel that cannot be switched off is drawn black, with the errors of display_present. */
must_check int display_sleep(struct display *display, bool asleep);
/* Binds the framebuffer to draw into. */
void display_begin(struct display *display);
/* Shows what was drawn, without waiting: display_ready is false until it is on the panel.
 * -ENOTRECOVERABLE: the GPU lost its context. -ESTALE as in display_dispatch. -EIO. */
must_check int display_present(struct display *display);

/* Reads the current framebuffer: 4 bytes a pixel, row 0 at the top; rgba is the caller's, of width
 * x height x 4 bytes. It waits for the GPU, so it is not for the frame path. Alpha is as drawn on a
 * headless display, undefined elsewhere. -ENOMEM, or as gl_check. */
must_check int display_read(struct display *display, uint8_t *rgba);

#endif
