/* A KMS card that can show a picture: its panel, mode, CRTC, plane, and the properties to set. */
#ifndef GOPURA_RENDER_DRM_CARD_H
#define GOPURA_RENDER_DRM_CARD_H

#include <stdbool.h>
#include <stdint.h>

#include <xf86drmMode.h>

#include "base/compiler.h"

enum { DRM_MODIFIERS_MOST = 32 };

/* Property ids; 0: the driver has no such property. */
struct drm_card_properties {
	uint32_t connector_crtc;
	uint32_t crtc_mode, crtc_active;
	uint32_t plane_fb, plane_crtc;
	uint32_t plane_src_x, plane_src_y, plane_src_w, plane_src_h;
	uint32_t plane_crtc_x, plane_crtc_y, plane_crtc_w, plane_crtc_h;
};

struct drm_card {
	int fd; /* owned */
	bool atomic;
	uint32_t connector, crtc, plane; /* plane is 0 without atomic */
	drmModeModeInfo mode;
	int width_mm;
	drmModeCrtc *crtc_before; /* owned; put back at the end */
	struct drm_card_properties properties;
	uint64_t modifiers[DRM_MODIFIERS_MOST]; /* of XRGB8888 on the plane, by IN_FORMATS */
	uint32_t modifier_count;
};

/* device, connector: NULL for the first that fits. width_px 0: the panel's preferred mode.
 * -ENODEV: no card with a connected panel that is free; the log says why for each card. */
must_check int drm_card_open(struct drm_card *out, const char *device, const char *connector,
			     int width_px, int height_px);
void drm_card_close(struct drm_card *card);

/* Shows framebuffer fb on the next vertical blank; a flip event with data follows. The first call
 * sets the mode. */
must_check int drm_card_flip(struct drm_card *card, uint32_t fb, bool set_mode, void *data);

#endif
