/* Where pictures appear: a KMS panel, a window for trying out, or memory. Creating one makes its
 * GLES2 context current; everything is for the thread that created it.
 *
 * The rotation of a panel lives in the projections (geometry/camera.h, render/overlay.h), never in
 * a plane property, so that it is the same on every board. */
#ifndef GOPURA_RENDER_DISPLAY_DISPLAY_H
#define GOPURA_RENDER_DISPLAY_DISPLAY_H

#include <stdbool.h>
#include <stdint.h>

#include "base/compiler.h"

enum display_kind {
	DISPLAY_AUTO, /* a free KMS panel, else a window where a desktop is, else headless */
	DISPLAY_DRM,
	DISPLAY_WINDOW,
	DISPLAY_HEADLESS
};

enum pointer_kind { POINTER_MOVE, POINTER_DOWN, POINTER_UP, POINTER_WHEEL };

struct display_options {
	enum display_kind kind;
	int width_px, height_px; /* DRM: the mode asked for, 0: what the panel prefers */
	int hz;                  /* DRM: likewise, 0: any */
	const char *device;      /* DRM: borrowed for the call; NULL: the first card with a panel */
	const char *connector;   /* DRM: such as "HDMI-A-1"; NULL: the first that is connected */
	const char *title;       /* window: borrowed for the call */

	/* Window: mouse as one finger; wheel_steps is above zero away from the user. */
	void (*pointer)(void *data, enum pointer_kind kind, float x_px, float y_px,
			float wheel_steps);
	void (*closed)(void *data); /* window: its close button */
	void *data;
};

struct display;

/* -ENODEV: no such display here (the log says why). */
must_check int display_create(struct display **out, const struct display_options *options);
void display_destroy(struct display *display); /* NULL and half-built are fine */

enum display_kind display_kind(const struct display *display);
int display_width_px(const struct display *display);
int display_height_px(const struct display *display);
/* Of the glass, from the panel's EDID; 0: not known. */
int display_width_mm(const struct display *display);

/* Readable when display_dispatch has something to do: a flip completed, the window has events;
 * -1: never. */
int display_fd(const struct display *display);
/* In how many milliseconds display_dispatch has something to do without the descriptor; -1: never.
 */
int display_wait_ms(const struct display *display);
/* -ETIMEDOUT: a flip did not complete within a second: the panel or its driver hangs. -ESTALE: a
 * panel of another size was plugged in: only a new process fits it. */
must_check int display_dispatch(struct display *display);

/* A frame may be drawn now: the last one is on the panel. */
bool display_ready(const struct display *display);
/* Nothing can be shown, which is no fault: no panel is plugged in, it is asleep, or another program
 * has it. */
bool display_is_dark(const struct display *display);
/* A frame is wanted although nothing changed: the last one is not, or no longer, on the panel.
 * Asking clears it. */
bool display_take_stale(struct display *display);
/* Switches the panel off and on; off only where display_ready. -ESTALE as display_dispatch. */
must_check int display_sleep(struct display *display, bool asleep);
/* Binds the framebuffer to draw into. */
void display_begin(struct display *display);
/* Shows what was drawn, without waiting: display_ready is false until it is on the panel.
 * -ENOTRECOVERABLE: the GPU lost its context. -ESTALE as display_dispatch. */
must_check int display_present(struct display *display);

/* What display_begin bound, as it is now: 4 bytes a pixel, row 0 on top. Waits for the GPU, so not
 * for the frame path. Alpha is what was drawn on a headless display, undefined elsewhere. */
must_check int display_read(struct display *display, uint8_t *rgba);

#endif
