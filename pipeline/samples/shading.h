/* Makes pictures from frames with 1 or 2 x 2 samples per pixel. The material's colour is expensive.
 * It is computed here, and not while triangles are drawn: where triangles are as small as a pixel,
 * a rasteriser shades each pixel several times. It is computed once for all samples of a pixel that
 * lie together, except detail finer than a pixel, which is averaged.
 *
 * Call everything from the thread that owns the GL context. */
#ifndef GOPURA_PIPELINE_SAMPLES_SHADING_H
#define GOPURA_PIPELINE_SAMPLES_SHADING_H

#include "geometry/camera.h"
#include "pipeline/samples/cube_frame.h"
#include "pipeline/samples/drawing.h"

/* The alpha of a picture is 8 times the number of samples that show anything (0..4), plus the
 * number of those that show a back. A single sample counts as four. */
enum { SHADING_SAMPLES = 4, SHADING_COVERED = 8 };

struct shading;

/* *out is owned by the caller; NULL on failure. width_px and height_px are the frame's and even; a
 * drawing with these options is drawn into it. side: samples per pixel and axis, 1 or 2. The frame
 * is borrowed for the shading's lifetime. Returns -ENOMEM or the errors of GL. */
must_check int shading_create(struct shading **out, const struct cube_frame *frame, int width_px,
			      int height_px, int side, const struct drawing_options *options);
void shading_destroy(struct shading *shading); /* NULL is fine */

/* Makes the picture of the frame's contents. Call it after frame_range; camera is the one of the
 * drawing, with the frame's width and height. The picture is `side` times narrower and lower, 4
 * bytes per pixel, row 0 on top. rgb is the mean of the samples that show anything, black if none
 * does. *rgba is borrowed until the next call. */
must_check int shading_take(struct shading *shading, const struct camera *camera,
			    const uint8_t **rgba);

#endif
