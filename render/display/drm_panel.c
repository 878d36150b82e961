/* Runs the state machine of a KMS panel: watches the card and hot-plug events, retries while
 * another program has the card, and detects flips that hang. */
#include "render/display/drm_panel.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <unistd.h>

#include <xf86drm.h>

#include "base/clock.h"
#include "base/log.h"
#include "render/display/drm_flip.h"
#include "render/display/uevent.h"

enum {
	FLIP_MOST_MS = 1000,
	MODE_MOST_MS = 5000, /* of one that sets the mode: some panels take a second to switch on */
	RETRY_MS = 250,
	LOOK_AWAY_MS = 2000,  /* probes every connector, which takes tens of milliseconds */
	LOOK_SHOWN_MS = 5000, /* for drivers without hot-plug events; probes no connector */
	REFUSALS_MAX = 3,
	BUSY_MOST_MS = 60000,
};

/* ---- decisions */

enum drm_panel_step drm_panel_after_flip(int rc, unsigned refusals)
{
	if (rc == 0)
		return DRM_PANEL_GO_ON;
	if (drm_card_is_taken(rc))
		return DRM_PANEL_LATER;
	if (rc == -ENOMEM) /* checking the connector would not help */
		return DRM_PANEL_FAULT;
	return refusals < REFUSALS_MAX ? DRM_PANEL_LOOK : DRM_PANEL_FAULT;
}

enum drm_panel_step drm_panel_after_look(enum drm_card_news news, bool was_away, bool refused,
					 bool link_is_bad)
{
	switch (news) {
	case DRM_CARD_NO_PANEL:
		return DRM_PANEL_WAIT;
	case DRM_CARD_OTHER_PANEL:
		return DRM_PANEL_ANEW;
	case DRM_CARD_SAME_PANEL:
		break;
	}
	return was_away || refused || link_is_bad ? DRM_PANEL_SET_MODE : DRM_PANEL_GO_ON;
}

/* ---- life */

static int watch(struct drm_panel *panel, int fd)
{
	struct epoll_event event = { .events = EPOLLIN, .data.fd = fd };

	return epoll_ctl(panel->epoll_fd, EPOLL_CTL_ADD, fd, &event) < 0 ? -errno : 0;
}

static bool copy_text(const char **text)
{
	const char *given = *text;

	*text = given ? strdup(given) : NULL;
	return !given || *text;
}

static void plan_look(struct drm_panel *panel)
{
	panel->look_ms = clock_now_ms() + (panel->away ? LOOK_AWAY_MS : LOOK_SHOWN_MS);
}

int drm_panel_open(struct drm_panel *out, const struct drm_card_options *options)
{
	int rc;

	*out = (struct drm_panel){ .card.fd = -1, .epoll_fd = -1, .uevent_fd = -1 };
	out->options = *options;
	if (!copy_text(&out->options.device) | !copy_text(&out->options.connector))
		return -ENOMEM;
	rc = drm_card_open(&out->card, &out->options);
	if (rc < 0)
		return rc;
	out->away = !out->card.connected;
	out->epoll_fd = epoll_create1(EPOLL_CLOEXEC);
	if (out->epoll_fd < 0)
		return -errno;
	rc = watch(out, out->card.fd);
	out->uevent_fd = uevent_open();
	if (rc == 0 && out->uevent_fd >= 0)
		rc = watch(out, out->uevent_fd);
	plan_look(out);
	return rc;
}

void drm_panel_close(struct drm_panel *panel)
{
	drm_card_close(&panel->card);
	if (panel->uevent_fd >= 0)
		close(panel->uevent_fd);
	if (panel->epoll_fd >= 0)
		close(panel->epoll_fd);
	free((char *)panel->options.device);
	free((char *)panel->options.connector);
	*panel = (struct drm_panel){ .card.fd = -1, .epoll_fd = -1, .uevent_fd = -1 };
}

int drm_panel_fd(const struct drm_panel *panel)
{
	return panel->epoll_fd;
}

/* ---- waiting */

bool drm_panel_ready(const struct drm_panel *panel)
{
	return !panel->flip_pending && !drm_panel_dark(panel) && panel->retry_ms == 0;
}

bool drm_panel_dark(const struct drm_panel *panel)
{
	return panel->away || panel->asleep || panel->taken;
}

bool drm_panel_take_stale(struct drm_panel *panel)
{
	const bool stale = panel->stale && drm_panel_ready(panel);

	if (stale)
		panel->stale = false;
	return stale;
}

static int64_t earlier(int64_t a_ms, int64_t b_ms)
{
	if (a_ms == 0 || b_ms == 0)
		return a_ms ? a_ms : b_ms;
	return a_ms < b_ms ? a_ms : b_ms;
}

int drm_panel_wait_ms(const struct drm_panel *panel)
{
	int64_t due_ms = panel->asleep ? 0 : earlier(panel->look_ms, panel->retry_ms), left_ms;

	if (panel->flip_pending && !panel->away)
		due_ms = earlier(due_ms, panel->flip_asked_ms + panel->flip_most_ms + 1);
	if (due_ms == 0)
		return -1;
	left_ms = due_ms - clock_now_ms();
	return left_ms > 0 ? (int)left_ms : 0;
}

/* ---- looking */

static int look(struct drm_panel *panel, bool refused)
{
	const bool was_away = panel->away, was_unseen = panel->unseen;
	const enum drm_card_news news = drm_card_look(&panel->card, &panel->options);

	panel->away = news == DRM_CARD_NO_PANEL;
	panel->unseen = false;
	if (panel->away)
		panel->busy_since_ms = 0; /* what the driver had to do ends with the panel */
	plan_look(panel);
	switch (drm_panel_after_look(news, was_away || was_unseen, refused,
				     panel->card.link_is_bad)) {
	case DRM_PANEL_WAIT:
		if (!was_away)
			log_warn("render", "the panel was unplugged");
		break;
	case DRM_PANEL_ANEW:
		return -ESTALE;
	case DRM_PANEL_SET_MODE:
		if (was_away)
			log_info("render", "the panel is connected again");
		panel->mode_is_set = false;
		panel->stale = true;
		if (panel->flip_pending) /* restart its timeout */
			panel->flip_asked_ms = clock_now_ms();
		break;
	default:
		break;
	}
	return 0;
}

/* Checks the connector state that the kernel already knows, without probing the panel. */
static bool seems_changed(const struct drm_panel *panel)
{
	drmModeConnector *connector =
		drmModeGetConnectorCurrent(panel->card.fd, panel->card.connector);
	const bool connected = connector && connector->connection != DRM_MODE_DISCONNECTED;

	drmModeFreeConnector(connector);
	return !connected;
}

static void on_flip(int fd, unsigned int sequence, unsigned int seconds, unsigned int microseconds,
		    void *data)
{
	struct drm_panel *panel = data;

	(void)fd, (void)sequence, (void)seconds, (void)microseconds;
	panel->flip_pending = false;
}

static int look_if_due(struct drm_panel *panel)
{
	const bool plugged = panel->uevent_fd >= 0 && uevent_take(panel->uevent_fd);
	const bool due = panel->look_ms != 0 && clock_now_ms() >= panel->look_ms;

	if (panel->asleep) /* many panels disconnect while asleep */
		return 0;
	if (plugged || (due && (panel->away || panel->unseen || seems_changed(panel))))
		return look(panel, false);
	if (due)
		plan_look(panel);
	return 0;
}

int drm_panel_dispatch(struct drm_panel *panel, bool *flipped)
{
	drmEventContext events = { .version = 2, .page_flip_handler = on_flip };
	const bool was_pending = panel->flip_pending;
	int rc;

	*flipped = false;
	if (drmHandleEvent(panel->card.fd, &events) < 0 && errno != EAGAIN)
		return -errno;
	*flipped = was_pending && !panel->flip_pending;
	rc = look_if_due(panel);
	if (rc < 0)
		return rc;
	if (panel->retry_ms != 0 && clock_now_ms() >= panel->retry_ms) {
		panel->retry_ms = 0;
		if (panel->taken && !drmIsMaster(panel->card.fd) &&
		    drmSetMaster(panel->card.fd) < 0)
			panel->retry_ms = clock_now_ms() + RETRY_MS;
		else
			panel->taken = false;
	}
	if (panel->flip_pending && !panel->away &&
	    clock_now_ms() - panel->flip_asked_ms > panel->flip_most_ms) {
		if (seems_changed(panel)) /* and no event said so yet */
			return look(panel, false);
		log_error("render", "board bug: a page flip did not complete within %lld s",
			  (long long)panel->flip_most_ms / 1000);
		return -ETIMEDOUT;
	}
	return 0;
}

/* ---- showing */

/* Returns whether the card has been busy for too long although it is ours: what it was told to do
 * before will never end. */
static bool is_stuck(struct drm_panel *panel, int rc)
{
	if (rc != -EBUSY || !drmIsMaster(panel->card.fd)) {
		panel->busy_since_ms = 0;
		return false;
	}
	if (panel->busy_since_ms == 0)
		panel->busy_since_ms = clock_now_ms();
	return clock_now_ms() - panel->busy_since_ms > BUSY_MOST_MS;
}

static int refused(struct drm_panel *panel, int rc)
{
	const enum drm_panel_step step =
		is_stuck(panel, rc) ? DRM_PANEL_FAULT : drm_panel_after_flip(rc, panel->refusals);

	panel->stale = true;
	if (step == DRM_PANEL_LATER) {
		if (!panel->taken_said)
			log_info("render",
				 "another program controls the panel (%s); waiting for it to end",
				 strerror(-rc));
		panel->taken = panel->taken_said = true;
		panel->mode_is_set = false; /* the other program may change the mode */
		panel->retry_ms = clock_now_ms() + RETRY_MS;
		return 0;
	}
	if (step != DRM_PANEL_LOOK) {
		log_error("render", "the panel refused a picture of %d x %d at %u Hz: %s%s",
			  panel->card.mode.hdisplay, panel->card.mode.vdisplay,
			  panel->card.mode.vrefresh, strerror(-rc),
			  rc == -ENODEV || rc == -ENOMEM || rc == -EBUSY
				  ? ""
				  : "; give another mode with --size, or in section [panel] of "
				    "gopura.conf");
		return rc;
	}
	panel->refusals++;
	log_warn("render", "the panel refused a picture (%s); its modes are read again",
		 strerror(-rc));
	panel->retry_ms = clock_now_ms() + RETRY_MS;
	return look(panel, true);
}

int drm_panel_show(struct drm_panel *panel, uint32_t fb, bool *shown)
{
	const int rc = drm_card_flip(&panel->card, fb, !panel->mode_is_set, panel);

	*shown = rc == 0;
	if (rc < 0)
		return refused(panel, rc);
	if (panel->taken_said)
		log_info("render", "the kiosk controls the panel again");
	panel->taken_said = false;
	panel->refusals = 0;
	panel->busy_since_ms = 0;
	panel->flip_most_ms = panel->mode_is_set ? FLIP_MOST_MS : MODE_MOST_MS;
	panel->mode_is_set = true;
	panel->flip_pending = true;
	panel->flip_asked_ms = clock_now_ms();
	return 0;
}

int drm_panel_sleep(struct drm_panel *panel, bool asleep)
{
	enum drm_card_news news;

	if (asleep == panel->asleep)
		return 0;
	panel->asleep = asleep;
	if (asleep)
		return panel->away ? 0 : drm_card_sleep(&panel->card);
	panel->mode_is_set = false;
	panel->stale = true;
	if (drm_card_wake(&panel->card) < 0)
		log_debug("render", "the panel is woken by a picture instead of DPMS");
	/* A panel that disconnected in its sleep may come back only for a signal: it is given one,
	 * and looked for after that. */
	news = drm_card_look(&panel->card, &panel->options);
	panel->unseen = news == DRM_CARD_NO_PANEL;
	plan_look(panel);
	return news == DRM_CARD_OTHER_PANEL ? -ESTALE : 0;
}
