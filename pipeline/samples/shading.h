/* Makes pictures from frames with 1 or 2 x 2 samples per pixel, for scans with pictures; resolve.h
 * is for all others.
 *
 * Call everything from the thread that owns the GL context. */
#ifndef GOPURA_PIPELINE_SAMPLES_SHADING_H
#define GOPURA_PIPELINE_SAMPLES_SHADING_H

#include "pipeline/samples/cube_frame.h"

/* The alpha of a picture is 8 times the number of samples that show anything (0..4), plus the
 * number of those that show a back. A single sample counts as four. */
enum { SHADING_SAMPLES = 4, SHADING_COVERED = 8 };

struct shading;

/* *out is owned by the caller; NULL on failure. width_px and height_px are the frame's, and even.
 * side: samples per pixel and axis, 1 or 2. The frame is borrowed for the shading's lifetime.
 * Returns -ENOMEM or the errors of GL. */
must_check int shading_create(struct shading **out, const struct cube_frame *frame, int width_px,
			      int height_px, int side);
void shading_destroy(struct shading *shading); /* NULL is fine */

/* Makes the picture of the frame's contents. Call it after cube_frame_range. The picture is `side`
 * times narrower and lower, 4 bytes per pixel, row 0 on top. rgb is the mean of the samples that
 * show anything, black if none does. *rgba is borrowed until the next call. */
must_check int shading_take(struct shading *shading, const uint8_t **rgba);

#endif
