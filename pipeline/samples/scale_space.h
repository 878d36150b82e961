/* Feature points of a range image at growing scales, after Cheng and Boulanger, "Scale-Space 3D
 * TexMesh Simplification" (paper P2), sections 2 and 3: the image is smoothed with Gaussians of
 * growing sigma, and zero crossings of the Laplacian of Gaussian are the feature points of a scale.
 * docs/quality.md has figures.
 *
 * Texels hold one over the distance along the line of sight instead of the distance: across a plane
 * it changes linearly from texel to texel, so that a plane has no feature from any point of view.
 */
#ifndef GOPURA_PIPELINE_SAMPLES_SCALE_SPACE_H
#define GOPURA_PIPELINE_SAMPLES_SCALE_SPACE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/compiler.h"

enum { SCALE_SPACE_SIDE_PX_MAX = 4096, SCALE_SPACE_SCALES_MAX = 16, SCALE_SPACE_SIGMA_PX_MAX = 32 };

struct range_image {
	uint32_t width_px, height_px; /* 1 .. SCALE_SPACE_SIDE_PX_MAX */
	/* One over metres, row by row, row 0 on top; 0: nothing is seen there. Borrowed. Texels
	 * that see nothing have no weight when their neighbours are smoothed. */
	const float *inverse_m;
};

struct scale_space_options {
	uint32_t scale_count; /* 1 .. SCALE_SPACE_SCALES_MAX */
	/* Of scales 1 .. scale_count, in texels: above 0, ascending, at most
	 * SCALE_SPACE_SIGMA_PX_MAX. */
	float sigma_px[SCALE_SPACE_SCALES_MAX];
	/* The lowest step in depth that counts, as a share of its distance from the viewer; above
	 * 0. The zero crossing of a step is equally strong at every scale, while that of
	 * noise decreases with sigma. */
	float step_share;
};

/* For every texel, the last scale at which it is a feature point. */
struct scale_map {
	uint32_t width_px, height_px, scale_count;
	uint8_t *scales; /* owned; 1 .. scale_count; 0: at no scale */
};

/* *out is owned by the caller (scale_map_finish); zeroed on failure. Returns -EINVAL for sizes or
 * options out of range, or -ENOMEM. Every processor gets the same map. */
must_check int scale_map_make(struct scale_map *out, const struct range_image *image,
			      const struct scale_space_options *options);
void scale_map_finish(struct scale_map *map); /* NULL and zeroed are fine */

/* The feature points of a map, those that survive longest first; points of one scale in the order
 * of rows, then columns. */
struct feature_queue {
	uint32_t *points; /* owned; row * width_px + column */
	uint32_t next;    /* of points; the next one to be popped */
	uint32_t scale_count;
	/* How many points survive at least to scale i; [scale_count + 1] is 0. */
	uint32_t counts[SCALE_SPACE_SCALES_MAX + 2];
};

/* Takes time proportional to the texels. *out is owned by the caller (feature_queue_finish); zeroed
 * on failure. Returns -ENOMEM. */
must_check int feature_queue_make(struct feature_queue *out, const struct scale_map *map);
void feature_queue_finish(struct feature_queue *queue); /* NULL and zeroed are fine */
/* Pops the next point that survives at least to the scale, in constant time. Returns false if there
 * is none left. scale is 1 or more. */
bool feature_queue_pop(struct feature_queue *queue, uint32_t scale, uint32_t *point);

#endif
