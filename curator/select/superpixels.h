/* Cuts a view into small pieces of about equal size whose borders follow creases, colours and steps
 * in depth: a watershed of the view's contrast, flooded from one marker in each square of a grid
 * and held compact (waterpixels, Machairas et al. 2015). The selection tools decide about pieces
 * first, because there are a hundred times fewer of them than pixels. */
#ifndef GOPURA_CURATOR_SELECT_SUPERPIXELS_H
#define GOPURA_CURATOR_SELECT_SUPERPIXELS_H

#include "base/compiler.h"
#include "curator/select/view_image.h"

#define SUPERPIXEL_NONE UINT32_MAX

enum { SUPERPIXEL_SIDE_PX = 8 };

/* Means over the pixels of one. */
struct superpixel {
	float colour[3], normal[3]; /* as in view_image, the normal a unit vector or zero */
	uint32_t pixel_count;
};

/* Where two superpixels touch. */
struct superpixel_border {
	uint32_t a, b; /* a < b */
	uint32_t length_px;
	float step; /* mean of contrast_step along it */
};

/* All arrays are owned. */
struct superpixels {
	uint32_t count, border_count, border_room;
	uint32_t *of_pixel; /* SUPERPIXEL_NONE: nothing shows there */
	struct superpixel *all;
	struct superpixel_border *borders;
};

/* *out is finished by the caller; zeroed on failure. -ENOMEM. */
must_check int superpixels_make(struct superpixels *out, const struct view_image *image);
/* Returns what a border costs per pixel of its length (contrast_border_cost), from the means of the
 * two that it divides. */
float superpixel_border_cost(const struct superpixels *superpixels,
			     const struct superpixel_border *border);
void superpixels_finish(struct superpixels *superpixels); /* NULL and zeroed are fine */

#endif
