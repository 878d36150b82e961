/* Pictures out of frames that hold 1 or 2 x 2 samples a pixel. What is dear, the stone's colour, is
 * found here and not as triangles are drawn: where those are as small as a pixel a rasteriser
 * shades each pixel several times. And once for all samples of a pixel that lie together, but for
 * detail finer than a pixel, which is averaged.
 *
 * Every call is from the thread that owns the GL context. */
#ifndef GOPURA_PIPELINE_SAMPLES_SHADING_H
#define GOPURA_PIPELINE_SAMPLES_SHADING_H

#include "geometry/camera.h"
#include "pipeline/samples/cube_frame.h"
#include "pipeline/samples/drawing.h"

/* Alpha of a picture is 8 times the samples that show anything, 0..4, plus those that show a back;
 * a single sample counts as four. */
enum { SHADING_SAMPLES = 4, SHADING_COVERED = 8 };

struct shading;

/* For frames of that many pixels, even, into which a drawing with these options is drawn; side:
 * samples a pixel's, 1 or 2. The frame is borrowed for as long as the shading lives. */
must_check int shading_create(struct shading **out, const struct frame *frame, int width_px,
			      int height_px, int side, const struct drawing_options *options);
void shading_destroy(struct shading *shading); /* NULL is fine */

/* The picture of what the frame holds, after frame_range and seen by camera, whose width and height
 * are the frame's: `side` times less wide and high, 4 bytes a pixel, row 0 on top. rgb is the mean
 * of the samples that show anything, black where none does. *rgba is borrowed until the next call.
 */
must_check int shading_take(struct shading *shading, const struct camera *camera,
			    const uint8_t **rgba);

#endif
