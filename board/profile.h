/* What differs between boards, as data: the panel and how it hangs, the touch sensor, budgets.
 * A profile is an ini file (docs/board.md); what it leaves out keeps the default. */
#ifndef GOPURA_BOARD_PROFILE_H
#define GOPURA_BOARD_PROFILE_H

#include <stdint.h>

#include "base/compiler.h"

struct profile {
	/* [panel] */
	int rotation_deg; /* 0, 90, 180, 270, clockwise; of panel and touch together */
	int width_mm;     /* of the glass as KMS counts its width; 0: by EDID */
	/* [touch] */
	float matrix[6]; /* calibration, as LIBINPUT_CALIBRATION_MATRIX; all zero: none */
	float edge_mm;   /* touches nearer to the edge are ignored */
	float palm_mm;   /* contacts wider than this are palms; 0: no limit */
	/* [render] */
	uint32_t triangles;    /* drawn in a frame */
	uint32_t texture_mib;  /* tiles and disparity */
	uint32_t geometry_mib; /* patches in memory */
	float error_px;        /* of a patch on the screen before a finer one is wanted */
	float price_px_per_kb; /* pixels that a fetched kilobyte must mend */
	uint32_t upload_us;    /* of a frame, for uploads */
	uint32_t workers;      /* threads that decode */
	/* [cache] */
	uint32_t cache_mib; /* on disk */
};

extern const struct profile profile_default;

/* *out starts as profile_default. path NULL: only that. -ENOENT and others of the file; -EINVAL:
 * the log names the file, the line and what it may say. */
must_check int profile_read(struct profile *out, const char *path);

#endif
