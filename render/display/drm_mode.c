/* Picks the mode that matches size and rate best, or computes CVT timings for a panel without
 * EDID. */
#include "render/display/drm_mode.h"

#include <stdio.h>
#include <stdlib.h>

enum {
	/* Constants of CVT reduced blanking, in pixels, lines and microseconds. */
	BLANK_PX = 160,
	SYNC_PX = 32,
	FRONT_PX = 48,
	FRONT_LINES = 3,
	BACK_LINES_MIN = 6,
	BLANK_LEAST_US = 460,
	CLOCK_STEP_KHZ = 250,
};

/* Returns the width of the vertical sync in lines; by CVT it encodes the aspect ratio. */
static int sync_lines(int width_px, int height_px)
{
	if (width_px * 3 == height_px * 4)
		return 4;
	if (width_px * 9 == height_px * 16)
		return 5;
	if (width_px * 10 == height_px * 16)
		return 6;
	return width_px * 4 == height_px * 5 || width_px * 9 == height_px * 15 ? 7 : 10;
}

/* XGA at 60 Hz (VESA DMT), which practically every flat panel accepts. */
static void make_fallback(drmModeModeInfo *out)
{
	*out = (drmModeModeInfo){
		.clock = 65000,
		.hdisplay = DRM_MODE_FALLBACK_WIDTH_PX,
		.hsync_start = 1048,
		.hsync_end = 1184,
		.htotal = 1344,
		.vdisplay = DRM_MODE_FALLBACK_HEIGHT_PX,
		.vsync_start = 771,
		.vsync_end = 777,
		.vtotal = 806,
		.vrefresh = 60,
		.flags = DRM_MODE_FLAG_NHSYNC | DRM_MODE_FLAG_NVSYNC,
		.type = DRM_MODE_TYPE_USERDEF,
		.name = "1024x768",
	};
}

void drm_mode_make(drmModeModeInfo *out, int width_px, int height_px, int hz)
{
	const int rate = hz ? hz : 60, sync = sync_lines(width_px, height_px);
	const double line_us = (1e6 / rate - BLANK_LEAST_US) / height_px;
	int blank = (int)(BLANK_LEAST_US / line_us) + 1, total_px, total_lines;
	double clock_khz;

	if (blank < FRONT_LINES + sync + BACK_LINES_MIN)
		blank = FRONT_LINES + sync + BACK_LINES_MIN;
	total_px = width_px + BLANK_PX;
	total_lines = height_px + blank;
	clock_khz = (double)rate * total_px * total_lines / 1000;
	*out = (drmModeModeInfo){
		.clock = (uint32_t)(clock_khz / CLOCK_STEP_KHZ) * CLOCK_STEP_KHZ,
		.hdisplay = (uint16_t)width_px,
		.hsync_start = (uint16_t)(width_px + FRONT_PX),
		.hsync_end = (uint16_t)(width_px + FRONT_PX + SYNC_PX),
		.htotal = (uint16_t)total_px,
		.vdisplay = (uint16_t)height_px,
		.vsync_start = (uint16_t)(height_px + FRONT_LINES),
		.vsync_end = (uint16_t)(height_px + FRONT_LINES + sync),
		.vtotal = (uint16_t)total_lines,
		.vrefresh = (uint32_t)rate,
		.flags = DRM_MODE_FLAG_PHSYNC | DRM_MODE_FLAG_NVSYNC,
		.type = DRM_MODE_TYPE_USERDEF,
	};
	snprintf(out->name, sizeof(out->name), "%dx%d", width_px, height_px);
}

/* Interlaced modes flicker on thin lines; they are used only if nothing else is offered. */
static bool interlaced(const drmModeModeInfo *mode)
{
	return (mode->flags & DRM_MODE_FLAG_INTERLACE) != 0;
}

/* Returns whether a is better than b, where both have the size asked for. */
static bool better(const drmModeModeInfo *a, const drmModeModeInfo *b, int hz)
{
	const int off_a = hz ? abs((int)a->vrefresh - hz) : 0;
	const int off_b = hz ? abs((int)b->vrefresh - hz) : 0;
	const bool liked_a = (a->type & DRM_MODE_TYPE_PREFERRED) != 0;
	const bool liked_b = (b->type & DRM_MODE_TYPE_PREFERRED) != 0;

	if (interlaced(a) != interlaced(b))
		return interlaced(b);
	if (off_a != off_b)
		return off_a < off_b;
	return liked_a && !liked_b;
}

static const drmModeModeInfo *find(const drmModeModeInfo *modes, int count, int width_px,
				   int height_px, int hz)
{
	const drmModeModeInfo *best = NULL;

	for (int i = 0; i < count; i++)
		if ((width_px == 0 ||
		     (modes[i].hdisplay == width_px && modes[i].vdisplay == height_px)) &&
		    (!best || better(&modes[i], best, hz)))
			best = &modes[i];
	return best;
}

enum drm_mode_reason drm_mode_choose(drmModeModeInfo *out, const drmModeModeInfo *modes, int count,
				     bool has_edid, const struct drm_mode_wish *wish)
{
	const drmModeModeInfo *found;

	if (wish->width_px) {
		found = find(modes, count, wish->width_px, wish->height_px, wish->hz);
		if (found) {
			*out = *found;
			return wish->hz && abs((int)found->vrefresh - wish->hz) > 1
				       ? DRM_MODE_OTHER_RATE
				       : DRM_MODE_AS_WISHED;
		}
		if (!has_edid) {
			drm_mode_make(out, wish->width_px, wish->height_px, wish->hz);
			return DRM_MODE_MADE;
		}
	}
	found = find(modes, count, 0, 0, 0);
	if (found) {
		*out = *found;
		return wish->width_px ? DRM_MODE_UNKNOWN : DRM_MODE_PREFERRED;
	}
	make_fallback(out);
	return DRM_MODE_MADE;
}
