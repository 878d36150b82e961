/* The state machine of a KMS panel: it is plugged in and out, used by another program, put to
 * sleep, and may refuse pictures. The drawing code (GPU or CPU) only shows framebuffers and asks
 * when the next one is wanted. One thread. */
#ifndef GOPURA_RENDER_DISPLAY_DRM_PANEL_H
#define GOPURA_RENDER_DISPLAY_DRM_PANEL_H

#include <stdint.h>

#include "render/display/drm_card.h"

struct drm_panel {
	struct drm_card card;
	struct drm_card_options options; /* its strings are owned copies */
	int epoll_fd, uevent_fd;         /* uevent_fd is -1 where netlink is forbidden */
	bool away, asleep, taken;        /* the reasons why nothing is shown */
	bool taken_said;                 /* taken was logged; reset when a picture is shown */
	bool mode_is_set, flip_pending, stale;
	bool unseen; /* a picture is shown although no panel is connected, to wake one */
	int64_t flip_asked_ms, flip_most_ms; /* when it was asked for, and how long it may take */
	int64_t look_ms; /* when to check the connector next, unless the kernel reports a change */
	int64_t retry_ms;
	int64_t busy_since_ms; /* the card says so, but no other program has it; 0: it is not */
	unsigned refusals;     /* consecutive ones */
};

/* Opens a card and starts to watch it. options are copied. -ENODEV: no suitable card (logged).
 * -ENOMEM or the errno of epoll; then call drm_panel_close as well. */
must_check int drm_panel_open(struct drm_panel *out, const struct drm_card_options *options);
/* Closes the card and frees everything. A half-opened panel is fine. */
void drm_panel_close(struct drm_panel *panel);

/* Returns a descriptor, borrowed, that is readable when drm_panel_dispatch has work; it also has
 * work after drm_panel_wait_ms. */
int drm_panel_fd(const struct drm_panel *panel);
/* Returns the milliseconds until drm_panel_dispatch has work; -1: no limit. */
int drm_panel_wait_ms(const struct drm_panel *panel);
/* Handles flips, hot-plug and retries. *flipped: the last picture is on the panel, and the buffer
 * of the one before it is free. -ETIMEDOUT: a flip did not complete in time; the panel or
 * its driver hangs. -ESTALE: another panel, whose size differs; the process must start again. */
must_check int drm_panel_dispatch(struct drm_panel *panel, bool *flipped);

/* Returns whether a picture may be shown now. */
bool drm_panel_ready(const struct drm_panel *panel);
/* Returns whether there is no usable panel although there is no fault. */
bool drm_panel_dark(const struct drm_panel *panel);
/* Returns whether a picture must be drawn although nothing changed, because the last one is not, or
 * no longer, on the panel. The call clears this state. */
bool drm_panel_take_stale(struct drm_panel *panel);

/* Shows a framebuffer. *shown says whether it was accepted; if not, a new picture is requested
 * (stale) as soon as the panel is ready. Negative errno: the panel refuses every picture. -ESTALE
 * as in drm_panel_dispatch. */
must_check int drm_panel_show(struct drm_panel *panel, uint32_t fb, bool *shown);

/* Switches the panel off or on; off only where drm_panel_ready. -EOPNOTSUPP and other errors: it
 * stays lit, but counts as asleep. -ESTALE as in drm_panel_dispatch. */
must_check int drm_panel_sleep(struct drm_panel *panel, bool asleep);

/* ---- decisions, exposed for tests */

enum drm_panel_step {
	DRM_PANEL_GO_ON,
	DRM_PANEL_LATER,    /* another program has the card: try again */
	DRM_PANEL_LOOK,     /* refused: check what is plugged in, then set the mode */
	DRM_PANEL_SET_MODE, /* the panel came back, or needs its mode again */
	DRM_PANEL_WAIT,     /* nothing is plugged in */
	DRM_PANEL_ANEW,     /* another panel is plugged in: restart the process */
	DRM_PANEL_FAULT,
};

/* Decides what to do after a flip that the kernel answered with rc; refusals counts the consecutive
 * refusals before it. */
enum drm_panel_step drm_panel_after_flip(int rc, unsigned refusals);
/* Decides what to do after drm_card_look. was_away: nothing was plugged in before. refused: the
 * check follows a refused flip. link_is_bad: the link needs a new mode set. */
enum drm_panel_step drm_panel_after_look(enum drm_card_news news, bool was_away, bool refused,
					 bool link_is_bad);

#endif
