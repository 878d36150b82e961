/* A KMS card that can show a picture: its panel, mode, CRTC, plane, and the properties to set. */
#ifndef GOPURA_RENDER_DISPLAY_DRM_CARD_H
#define GOPURA_RENDER_DISPLAY_DRM_CARD_H

#include <stdbool.h>
#include <stdint.h>

#include <xf86drmMode.h>

#include "base/compiler.h"
#include "render/display/drm_mode.h"

enum { DRM_MODIFIERS_MAX = 32 };

struct drm_card_options {
	const char *device;    /* NULL: the first card with a panel */
	const char *connector; /* such as "HDMI-A-1"; NULL: the first with a panel */
	struct drm_mode_wish mode;
	bool may_wait; /* a card without a panel will do where there is none with one */
};

/* Property ids; 0: the driver has no such property. */
struct drm_card_properties {
	uint32_t connector_crtc, connector_link; /* the latter may be missing */
	uint32_t crtc_mode, crtc_active;
	uint32_t plane_fb, plane_crtc;
	uint32_t plane_src_x, plane_src_y, plane_src_w, plane_src_h;
	uint32_t plane_crtc_x, plane_crtc_y, plane_crtc_w, plane_crtc_h;
};

struct drm_card {
	int fd; /* owned */
	bool atomic;
	bool connected, link_is_bad;     /* as last looked at */
	uint32_t connector, crtc, plane; /* plane is 0 without atomic */
	drmModeModeInfo mode;
	int width_mm;
	drmModeCrtc *crtc_before; /* owned; put back at the end */
	struct drm_card_properties properties;
	uint64_t modifiers[DRM_MODIFIERS_MAX]; /* of XRGB8888 on the plane, by IN_FORMATS */
	uint32_t modifier_count;
};

/* With may_wait, half a minute for a first card to come (where no device is named) and as long for
 * another program to give it up, in which this does not return. -ENODEV: no card with a connected
 * panel that is free; the log says why for each card. */
must_check int drm_card_open(struct drm_card *out, const struct drm_card_options *options);
void drm_card_close(struct drm_card *card);

enum drm_card_news {
	DRM_CARD_NO_PANEL,
	DRM_CARD_SAME_PANEL,  /* of the size there was; its rate may be another */
	DRM_CARD_OTHER_PANEL, /* of another size or on another connector: *card is as it was */
};

/* Asks the card what is plugged in, with the options it was opened with. May take some tens of
 * milliseconds: for a panel that is not there, or when the kernel says that something changed. */
enum drm_card_news drm_card_look(struct drm_card *card, const struct drm_card_options *options);

/* Shows framebuffer fb on the next vertical blank; a flip event with data follows. The first call,
 * and that after a change of panel or after drm_card_sleep, sets the mode. Negative errno: as the
 * kernel says. */
must_check int drm_card_flip(struct drm_card *card, uint32_t fb, bool set_mode, void *data);

/* Of a negative errno: another program or a suspend has the card for now; nothing is broken. */
bool drm_card_is_taken(int rc);

/* Switches the panel off, and lets the next flip that sets the mode switch it on. */
must_check int drm_card_sleep(struct drm_card *card);
must_check int drm_card_wake(struct drm_card *card);

#endif
