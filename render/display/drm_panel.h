/* The life of a KMS panel: it is plugged in and out, taken by another program, put to sleep, and
 * refuses pictures; who draws (by the GPU or by the CPU) shows framebuffers and needs to know only
 * when the next one is wanted. One thread. */
#ifndef GOPURA_RENDER_DISPLAY_DRM_PANEL_H
#define GOPURA_RENDER_DISPLAY_DRM_PANEL_H

#include <stdint.h>

#include "render/display/drm_card.h"

struct drm_panel {
	struct drm_card card;
	struct drm_card_options options; /* its strings are our copies */
	int epoll_fd, uevent_fd;         /* uevent_fd: -1 where netlink is forbidden */
	bool away, asleep, taken;        /* why nothing is shown */
	bool taken_said;                 /* until a picture is shown */
	bool mode_is_set, flip_pending, stale;
	int64_t flip_asked_ms;
	int64_t look_ms; /* when to look what is plugged in, unless the kernel says something */
	int64_t retry_ms;
	unsigned refusals; /* in a row */
};

/* options are copied. -ENODEV: no card that fits (logged). */
must_check int drm_panel_open(struct drm_panel *out, const struct drm_card_options *options);
void drm_panel_close(struct drm_panel *panel); /* half-opened is fine */

/* Readable when drm_panel_dispatch has something to do, as it also has after drm_panel_wait_ms. */
int drm_panel_fd(const struct drm_panel *panel);
/* Milliseconds; -1: for ever. */
int drm_panel_wait_ms(const struct drm_panel *panel);
/* *flipped: the last picture is on the panel, and the one before it is free.
 * -ETIMEDOUT: a flip did not complete within a second: the panel or its driver hangs.
 * -ESTALE: another panel, that this picture does not fit: begin anew. */
must_check int drm_panel_dispatch(struct drm_panel *panel, bool *flipped);

/* A picture may be shown now. */
bool drm_panel_ready(const struct drm_panel *panel);
/* There is nothing to show pictures on, which is no fault. */
bool drm_panel_dark(const struct drm_panel *panel);
/* A picture is wanted although nothing changed: the last one is not, or no longer, on the panel.
 * Asking clears it. */
bool drm_panel_take_stale(struct drm_panel *panel);

/* Shows a framebuffer: *shown says whether it was taken; what was not is wanted again (stale) when
 * the panel is ready. Negative errno: the panel refuses every picture. */
must_check int drm_panel_show(struct drm_panel *panel, uint32_t fb, bool *shown);

/* Off and on again; off only where drm_panel_ready. -EOPNOTSUPP and others: it stays lit, but is
 * taken for asleep. */
must_check int drm_panel_sleep(struct drm_panel *panel, bool asleep);

/* ---- what is decided, for tests */

enum drm_panel_step {
	DRM_PANEL_GO_ON,
	DRM_PANEL_LATER,    /* somebody else has the card: try again */
	DRM_PANEL_LOOK,     /* refused: see what is plugged in, then set the mode */
	DRM_PANEL_SET_MODE, /* it came back */
	DRM_PANEL_WAIT,     /* nothing is plugged in */
	DRM_PANEL_ANEW,     /* what is plugged in is another panel */
	DRM_PANEL_FAULT,
};

/* After a flip that the kernel answered with rc, refused so often in a row before. */
enum drm_panel_step drm_panel_after_flip(int rc, unsigned refusals);
/* After a look; was_away: nothing was plugged in before; refused: it is looked at for a refusal. */
enum drm_panel_step drm_panel_after_look(enum drm_card_news news, bool was_away, bool refused,
					 bool link_is_bad);

#endif
