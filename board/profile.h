/* What differs between boards, as data: the panel and its mounting, the touch sensor, and budgets.
 * A profile is an ini file (docs/board.md); a missing setting keeps its default. */
#ifndef GOPURA_BOARD_PROFILE_H
#define GOPURA_BOARD_PROFILE_H

#include <stdint.h>

#include "base/compiler.h"

/* Bounds of `triangles`, in a profile and on the command line. */
enum { PROFILE_TRIANGLES_LEAST = 10000, PROFILE_TRIANGLES_MOST = 20000000 };

struct profile {
	/* [panel] */
	int rotation_deg; /* 0, 90, 180, 270, clockwise; of panel and touch together */
	int width_mm;     /* visible width, along the KMS width; 0: by EDID */
	/* [touch] */
	float matrix[6]; /* calibration, as LIBINPUT_CALIBRATION_MATRIX; all zero: udev's, if any */
	float edge_mm;   /* touches nearer to the edge are ignored; 0: none */
	float palm_mm;   /* contacts wider than this are palms; 0: no limit */
	/* [render] */
	uint32_t triangles;    /* most triangles per frame */
	uint32_t texture_mib;  /* tiles and depth maps */
	uint32_t geometry_mib; /* patches, on the GPU and in memory */
	float scale_least;     /* of the picture's sides while the eye moves; 1: full size */
	float error_px;        /* error on the screen above which a finer patch is wanted */
	float price_px_per_kb; /* pixels that a fetched kilobyte must improve */
	uint32_t upload_us;    /* time for uploads per frame */
	uint32_t workers;      /* decoder threads */
	/* [cache] */
	uint32_t cache_mib; /* size of the cache on disk */
};

extern const struct profile profile_default;

/* Reads a profile. *out starts as profile_default; with path NULL it stays so. -ENOENT and other
 * errors of reading the file; -EINVAL: the log names the file, the line and the allowed values. */
must_check int profile_read(struct profile *out, const char *path);

#endif
