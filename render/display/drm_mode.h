/* Which mode a panel is driven in: pure. A panel that tells what it can (EDID) is taken at its
 * word; of one that tells nothing the size is believed that the engineer gave. */
#ifndef GOPURA_RENDER_DISPLAY_DRM_MODE_H
#define GOPURA_RENDER_DISPLAY_DRM_MODE_H

#include <stdbool.h>

#include <xf86drmMode.h>

enum { DRM_MODE_FALLBACK_WIDTH_PX = 1024, DRM_MODE_FALLBACK_HEIGHT_PX = 768 };

struct drm_mode_wish {
	int width_px, height_px; /* 0: what the panel prefers */
	int hz;                  /* 0: any */
};

enum drm_mode_reason {
	DRM_MODE_AS_WISHED,
	DRM_MODE_OTHER_RATE, /* the size wished for, but no rate within 1 Hz of it */
	DRM_MODE_PREFERRED,  /* nothing was wished for */
	DRM_MODE_UNKNOWN, /* by its EDID the panel has not the size wished for: what it prefers */
	DRM_MODE_MADE,    /* the panel says nothing: timings by rule */
};

/* modes, best first as the kernel lists them; count may be 0. */
enum drm_mode_reason drm_mode_choose(drmModeModeInfo *out, const drmModeModeInfo *modes, int count,
				     bool has_edid, const struct drm_mode_wish *wish);

/* VESA's coordinated video timings with reduced blanking, which flat panels take; hz 0: 60. */
void drm_mode_make(drmModeModeInfo *out, int width_px, int height_px, int hz);

#endif
