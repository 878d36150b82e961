/* A KMS card that can show pictures: its connector, mode, CRTC, plane, and the properties to
 * set. */
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
	/* accept a card without a panel if no card has one, and wait (drm_card_open) */
	bool may_wait;
};

/* Property ids; 0: the driver has no such property. */
struct drm_card_properties {
	uint32_t connector_crtc, connector_link; /* connector_link may be missing */
	uint32_t crtc_mode, crtc_active;
	uint32_t plane_fb, plane_crtc;
	uint32_t plane_src_x, plane_src_y, plane_src_w, plane_src_h;
	uint32_t plane_crtc_x, plane_crtc_y, plane_crtc_w, plane_crtc_h;
};

struct drm_card {
	int fd;     /* owned */
	int number; /* of /dev/dri/cardN, where no device is named */
	bool atomic;
	/* as of the last drm_card_look; a connector that cannot tell counts as connected */
	bool connected, link_is_bad;
	uint32_t connector, crtc, plane; /* plane is 0 without atomic */
	drmModeModeInfo mode;
	int width_mm;
	drmModeCrtc *crtc_before; /* owned; restored by drm_card_close */
	struct drm_card_properties properties;
	/* that the plane takes for XRGB8888, from IN_FORMATS */
	uint64_t modifiers[DRM_MODIFIERS_MAX];
	uint32_t modifier_count;
};

/* Opens a card and chooses its mode. Strings of the options are borrowed for the call. With
 * may_wait it blocks: up to half a minute for a card that drives panels to appear (where no device
 * is named), and as long for another program to release it. -ENODEV: no free card with a connected
 * panel; the log says why for each card. */
must_check int drm_card_open(struct drm_card *out, const struct drm_card_options *options);
/* Restores the picture from before, closes the card and frees what it holds. A card that was never
 * opened (fd -1) is fine. */
void drm_card_close(struct drm_card *card);

enum drm_card_news {
	DRM_CARD_NO_PANEL,
	DRM_CARD_SAME_PANEL, /* size and rate are unchanged */
	/* another size, in pixels or mm, another rate, another connector or another card, or the
	 * card is gone; *card is unchanged */
	DRM_CARD_OTHER_PANEL,
};

/* Asks the card what is plugged in; options are those it was opened with. It may take tens of
 * milliseconds, so call it only while no panel is connected, or when the kernel reports a
 * change. */
enum drm_card_news drm_card_look(struct drm_card *card, const struct drm_card_options *options);

#endif
