/* A framebuffer whose depth can be asked: how near and how far is what it shows? */
#ifndef GOPURA_PIPELINE_SAMPLES_CUBE_FRAME_H
#define GOPURA_PIPELINE_SAMPLES_CUBE_FRAME_H

#include <stdbool.h>
#include <stdint.h>

#include "base/compiler.h"

struct frame;

/* side_px is a multiple of 8. The pipeline's machines must have OES_depth_texture (llvmpipe has);
 * -ENOTSUP, logged, where they have not. */
must_check int frame_create(struct frame **out, int width_px, int height_px);
void frame_destroy(struct frame *frame); /* NULL is fine */
void frame_bind(const struct frame *frame);
/* To units 0 .. GL_LIMIT_UNITS - 1, for reading what was drawn while another framebuffer is bound.
 * Blocks, as the last frame_range left them: a pixel a square of 8, white where it shows nothing.
 */
void frame_bind_textures(const struct frame *frame, unsigned colour_unit, unsigned depth_unit,
			 unsigned blocks_unit);
/* Distance along the view's axis of what a perspective picture with these planes shows, each to
 * one part in 1000, near rounded down and far up. found: false where it shows nothing. */
must_check int frame_range(struct frame *frame, float plane_near_m, float plane_far_m, bool *found,
			   float *near_m, float *far_m);

#endif
