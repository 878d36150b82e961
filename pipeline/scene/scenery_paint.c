/* Edges of all triangles of a surface are divided into the same number of pieces, so that
 * neighbours keep their corners in common. */
#include "pipeline/scene/scenery_paint.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PIECES_MAX = 256 };

/* Finer than this, in pixels of the picture, nothing more shows. */
#define FINEST_PX 1.5f

static float edge_px(const struct picture *picture, const struct soup_corner *a,
		     const struct soup_corner *b)
{
	return hypotf((a->uv[0] - b->uv[0]) * (float)picture->width,
		      (a->uv[1] - b->uv[1]) * (float)picture->height);
}

/* Makes a picture of half the width and height, each at least 1. */
static int halve(struct picture *picture)
{
	struct picture half = { .width = (picture->width + 1) / 2,
				.height = (picture->height + 1) / 2 };

	half.rgba = malloc((size_t)half.width * half.height * 4);
	if (!half.rgba)
		return -ENOMEM;
	for (uint32_t y = 0; y < half.height; y++)
		for (uint32_t x = 0; x < half.width; x++)
			for (int k = 0; k < 4; k++) {
				uint32_t sum = 2;

				for (uint32_t i = 0; i < 4; i++) {
					uint32_t column = 2 * x + i % 2, row = 2 * y + i / 2;

					column -= column == picture->width;
					row -= row == picture->height;
					sum += picture->rgba[((size_t)row * picture->width +
							      column) *
								     4 +
							     (size_t)k];
				}
				half.rgba[((size_t)y * half.width + x) * 4 + (size_t)k] =
					(uint8_t)(sum / 4);
			}
	picture_finish(picture);
	*picture = half;
	return 0;
}

int scenery_paint_init(struct scenery_paint *out, const struct picture *picture,
		       const struct soup_triangle *triangles, uint32_t count, uint32_t most)
{
	const size_t bytes = (size_t)picture->width * picture->height * 4;
	float longest = 0, sum = 0, pieces, px;
	int rc = 0;

	*out = (struct scenery_paint){ .picture = *picture, .pieces = 1 };
	out->picture.rgba = malloc(bytes ? bytes : 1);
	if (!out->picture.rgba)
		return -ENOMEM;
	memcpy(out->picture.rgba, picture->rgba, bytes);
	for (uint32_t i = 0; i < count; i++)
		for (int k = 0; k < 3; k++) {
			const float edge = edge_px(picture, &triangles[i].corners[k],
						   &triangles[i].corners[(k + 1) % 3]);

			longest = fmaxf(longest, edge);
			sum += edge;
		}
	pieces = fminf(longest / FINEST_PX, sqrtf((float)most / (float)(count ? count : 1)));
	if (pieces >= 2)
		out->pieces = pieces < PIECES_MAX ? (uint32_t)pieces : PIECES_MAX;
	/* What lies between two corners is their mean. */
	for (px = sum / (3 * (float)(count ? count : 1) * (float)out->pieces);
	     rc == 0 && px >= 2 && (out->picture.width > 1 || out->picture.height > 1); px /= 2)
		rc = halve(&out->picture);
	if (rc < 0)
		scenery_paint_finish(out);
	return rc;
}

/* Returns the number of a pixel beside a place, and its share there. */
static uint32_t wrap(float at, uint32_t size, uint32_t *next, float *share)
{
	const float turns = at - floorf(at), px = turns * (float)size - 0.5f;
	const float low = floorf(px);
	const int64_t first = isfinite(low) ? (int64_t)low : 0;

	*share = isfinite(low) ? px - low : 0;
	*next = (uint32_t)((first + 1) % size);
	return (uint32_t)((first + size) % size);
}

void scenery_paint_colour(const struct scenery_paint *paint, const float uv[2], uint8_t rgb[3])
{
	const struct picture *picture = &paint->picture;
	float share_x, share_y;
	uint32_t x[2], y[2];

	x[0] = wrap(uv[0], picture->width, &x[1], &share_x);
	y[0] = wrap(1 - uv[1], picture->height, &y[1], &share_y);
	for (int k = 0; k < 3; k++) {
		float colour = 0;

		for (int i = 0; i < 4; i++)
			colour +=
				(i % 2 ? share_x : 1 - share_x) * (i / 2 ? share_y : 1 - share_y) *
				(float)picture
					->rgba[((size_t)y[i / 2] * picture->width + x[i % 2]) * 4 +
					       (size_t)k];
		rgb[k] = (uint8_t)(colour * (float)rgb[k] / 255 + 0.5f);
	}
}

void scenery_paint_finish(struct scenery_paint *paint)
{
	picture_finish(&paint->picture);
	*paint = (struct scenery_paint){ 0 };
}
