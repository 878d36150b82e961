/* A framebuffer with a readable depth texture. It can tell the nearest and farthest distance of
 * what it shows. */
#ifndef GOPURA_PIPELINE_SAMPLES_CUBE_FRAME_H
#define GOPURA_PIPELINE_SAMPLES_CUBE_FRAME_H

#include <stdbool.h>
#include <stdint.h>

#include "base/compiler.h"

struct cube_frame;

/* width_px and height_px are multiples of 8. *out is owned by the caller; NULL on failure. Returns
 * -ENOMEM, the errors of GL, or -ENOTSUP (logged) without OES_depth_texture, which the pipeline's
 * machines must have (llvmpipe has it). */
must_check int cube_frame_create(struct cube_frame **out, int width_px, int height_px);
void cube_frame_destroy(struct cube_frame *frame); /* NULL is fine */
/* Binds the framebuffer and sets the viewport to all of it. */
void cube_frame_bind(const struct cube_frame *frame);
/* Binds the frame's textures to units 0 .. GL_LIMIT_UNITS - 1, to read them while another
 * framebuffer is bound. The blocks texture has one pixel per 8 x 8 pixels, as the last
 * cube_frame_range left it; a white pixel means that nothing shows there. */
void cube_frame_bind_textures(const struct cube_frame *frame, unsigned colour_unit,
			      unsigned depth_unit, unsigned blocks_unit);
/* Finds the range of distances along the view axis of what a perspective picture with these planes
 * shows, metres. Each is accurate to one part in 1000; near is rounded down and far up. *found is
 * false if it shows nothing. Returns the errors of reading back. */
must_check int cube_frame_range(struct cube_frame *frame, float plane_near_m, float plane_far_m,
				bool *found, float *near_m, float *far_m);

#endif
