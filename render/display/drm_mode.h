/* Chooses the mode of a panel. Pure functions. A panel with an EDID is believed: only its modes are
 * used. For a panel without one, the size configured by the engineer is believed. */
#ifndef GOPURA_RENDER_DISPLAY_DRM_MODE_H
#define GOPURA_RENDER_DISPLAY_DRM_MODE_H

#include <stdbool.h>

#include <xf86drmMode.h>

enum { DRM_MODE_FALLBACK_WIDTH_PX = 1024, DRM_MODE_FALLBACK_HEIGHT_PX = 768 };

struct drm_mode_wish {
	int width_px, height_px; /* 0: the panel's preferred size */
	int hz;                  /* 0: any */
};

enum drm_mode_reason {
	DRM_MODE_AS_WISHED,
	DRM_MODE_OTHER_RATE, /* the size asked for, but no rate within 1 Hz of it */
	DRM_MODE_PREFERRED,  /* no size was asked for */
	DRM_MODE_UNKNOWN,    /* the EDID does not list the size asked for: the preferred mode */
	DRM_MODE_MADE,       /* the panel lists no mode: computed timings */
};

/* Chooses the mode. modes are in the order of the kernel, best first; count may be 0, then the
 * fallback size is used. Returns why this mode was chosen. */
enum drm_mode_reason drm_mode_choose(drmModeModeInfo *out, const drmModeModeInfo *modes, int count,
				     bool has_edid, const struct drm_mode_wish *wish);

/* Computes timings by VESA's Coordinated Video Timings (CVT) with reduced blanking, which flat
 * panels accept. hz 0 means 60. */
void drm_mode_make(drmModeModeInfo *out, int width_px, int height_px, int hz);

#endif
