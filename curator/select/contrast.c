/* Differences of colour, normal and depth, and what they make of the cost of a border. The paper
 * adds three costs (equation 4); we multiply them, because a crease without a change of colour then
 * attracts the border as much as one with it. docs/regions.md compares the two. */
#include "curator/select/contrast.h"

#include <math.h>

#include "geometry/vec.h"

/* Differences at which the cost of a border has fallen half way, and how low it falls. A step in
 * depth is the surest sign that something ends, then a crease; stains make colours the least. */
static const struct contrast half_way = { 15, 0.05f, 3 }, lowest = { 0.35f, 0.15f, 0.02f };

float contrast_colour(const float a[3], const float b[3])
{
	return vec_distance(a, b);
}

float contrast_turn(const float a[3], const float b[3])
{
	return vec_most(0, 1 - vec_dot(a, b));
}

/* The least of what the planes on both sides say: only where neither continues is there a step. */
float contrast_step(const struct view_image *image, uint32_t a, uint32_t b)
{
	const uint32_t count = image->width_px * image->height_px;
	const float *w = image->inverse_m;
	const float difference = w[b] - w[a], scale = image->px_per_radian / vec_most(w[a], w[b]);
	float least = INFINITY;

	/* Unsigned numbers wrap: what lies before the first pixel is beyond the last. */
	const uint32_t before = 2 * a - b, behind = 2 * b - a;
	if (before < count && w[before] > 0)
		least = fabsf(difference - (w[a] - w[before]));
	if (behind < count && w[behind] > 0)
		least = vec_least(least, fabsf(difference - (w[behind] - w[b])));
	return (isinf(least) ? fabsf(difference) : least) * scale;
}

struct contrast contrast_of_pixels(const struct view_image *image, uint32_t a, uint32_t b)
{
	float colour[2][3], normal[2][3];

	for (int i = 0; i < 3; i++) {
		colour[0][i] = image->colours[a][i];
		colour[1][i] = image->colours[b][i];
		normal[0][i] = (float)image->normals[a][i] / 127;
		normal[1][i] = (float)image->normals[b][i] / 127;
	}
	return (struct contrast){ contrast_colour(colour[0], colour[1]),
				  contrast_turn(normal[0], normal[1]), contrast_step(image, a, b) };
}

/* g of equation 4. */
static float falling(float difference, float half, float low)
{
	const float share = difference / half;

	return low + (1 - low) / (1 + share * share);
}

float contrast_border_cost(const struct contrast *contrast)
{
	return falling(contrast->colour, half_way.colour, lowest.colour) *
	       falling(contrast->turn, half_way.turn, lowest.turn) *
	       falling(contrast->step, half_way.step, lowest.step);
}
