/* How much two neighbours in a view differ, for the borders of superpixels and of parts (P0
 * equation 4). */
#ifndef GOPURA_CURATOR_SELECT_CONTRAST_H
#define GOPURA_CURATOR_SELECT_CONTRAST_H

#include "curator/select/view_image.h"

struct contrast {
	float colour; /* Euclidean distance in sRGB, 0 to 442 */
	float turn;   /* one minus the cosine of the angle between the normals, 0 to 2 */
	float step;   /* depth, against a plane that continues: in widths of a pixel there */
};

/* Returns how much two colours differ. */
float contrast_colour(const float a[3], const float b[3]);
/* Returns how much two unit vectors differ. */
float contrast_turn(const float a[3], const float b[3]);
/* Returns the step in depth between pixel a and its neighbour b, found from the pixels before and
 * behind them in that direction. b - a is the same for both pairs. Both show something. */
float contrast_step(const struct view_image *image, uint32_t a, uint32_t b);
/* Returns how much two neighbouring pixels differ; both show something. */
struct contrast contrast_of_pixels(const struct view_image *image, uint32_t a, uint32_t b);

/* Returns what a border costs, per pixel of its length, between two that differ by so much: 1
 * between equals, falling towards 0 as soon as one of the three differs. */
float contrast_border_cost(const struct contrast *contrast);

#endif
