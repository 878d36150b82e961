/* Pixels of the smaller picture are weighted means of those around them, row by row and then column
 * by column. */
#include "pipeline/scene/scenery_texture.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { QUALITY = 90, QUALITY_OF_MAP = 95, JPEG_BYTES_MAX = 16 << 20 };

struct scenery_source scenery_source_of(const struct picture *picture, bool repeats, bool is_map)
{
	const size_t bytes = (size_t)picture->width * picture->height * 4;

	return (struct scenery_source){ .pixels = hash_of((struct bytes){ picture->rgba, bytes }),
					.width = picture->width,
					.height = picture->height,
					.repeats = repeats,
					.is_map = is_map };
}

bool scenery_source_equals(const struct scenery_source *a, const struct scenery_source *b)
{
	return hash_equal(a->pixels, b->pixels) && a->width == b->width && a->height == b->height &&
	       a->repeats == b->repeats && a->is_map == b->is_map;
}

/* The nearest power of two, by its ratio. */
static uint32_t side_of(uint32_t px)
{
	uint32_t side = 1;

	while (side < SCENERY_TEXTURE_PX_MAX && (float)side * 1.41421356f < (float)px)
		side *= 2;
	return side;
}

/* The pixel at a place that may be outside. */
static uint32_t wrap(int64_t at, uint32_t size, bool repeats)
{
	if (repeats)
		return (uint32_t)((at % size + size) % size);
	return (uint32_t)(at < 0 ? 0 : at >= size ? size - 1 : at);
}

/* A line of `from` pixels becomes one of `to`; neighbours in a line are `stride` pixels apart. The
 * weights are a triangle as wide as a pixel of the coarser line, on each side. */
static void resample(uint8_t *out, uint32_t to, const uint8_t *in, uint32_t from, size_t stride,
		     size_t out_stride, bool repeats)
{
	const float scale = (float)from / (float)to, reach = fmaxf(scale, 1);

	for (uint32_t i = 0; i < to; i++) {
		const float middle = ((float)i + 0.5f) * scale - 0.5f;
		float sum[3] = { 0 }, weights = 0;

		for (int64_t at = (int64_t)ceilf(middle - reach); (float)at <= middle + reach;
		     at++) {
			const uint8_t *pixel = &in[4 * stride * wrap(at, from, repeats)];
			const float weight = fmaxf(1 - fabsf((float)at - middle) / reach, 0);

			weights += weight;
			for (int k = 0; k < 3; k++)
				sum[k] += weight * (float)pixel[k];
		}
		for (int k = 0; k < 3; k++)
			out[4 * out_stride * i + (size_t)k] = (uint8_t)(sum[k] / weights + 0.5f);
		out[4 * out_stride * i + 3] = 255;
	}
}

/* Sets *out to the picture in another size. */
static int fit(struct picture *out, const struct picture *in, bool repeats)
{
	uint8_t *between = malloc((size_t)out->width * in->height * 4);

	out->rgba = malloc((size_t)out->width * out->height * 4);
	for (uint32_t y = 0; between && out->rgba && y < in->height; y++)
		resample(&between[(size_t)4 * out->width * y], out->width,
			 &in->rgba[(size_t)4 * in->width * y], in->width, 1, 1, repeats);
	for (uint32_t x = 0; between && out->rgba && x < out->width; x++)
		resample(&out->rgba[(size_t)4 * x], out->height, &between[(size_t)4 * x],
			 in->height, out->width, out->width, repeats);
	free(between);
	return between && out->rgba ? 0 : -ENOMEM;
}

int scenery_texture_make(struct scenery_texture *out, const struct picture *picture, bool repeats,
			 bool is_map, uint32_t texels_most)
{
	struct picture fitted = { .width = side_of(picture->width),
				  .height = side_of(picture->height) };
	struct buffer jpeg;
	int rc;

	while ((uint64_t)fitted.width * fitted.height > texels_most) {
		if (fitted.width > fitted.height)
			fitted.width /= 2;
		else
			fitted.height /= 2;
	}
	buffer_init(&jpeg, JPEG_BYTES_MAX);
	rc = fit(&fitted, picture, repeats);
	if (rc == 0 && is_map)
		rc = picture_encode_fine_jpeg(&jpeg, &fitted, QUALITY_OF_MAP);
	else if (rc == 0)
		rc = picture_encode_jpeg(&jpeg, &fitted, QUALITY);
	*out = (struct scenery_texture){ .width = (uint16_t)fitted.width,
					 .height = (uint16_t)fitted.height,
					 .repeats = repeats,
					 .jpeg_bytes = (uint32_t)jpeg.size };
	if (rc == 0)
		out->jpeg = malloc(jpeg.size + 1);
	if (rc == 0 && !out->jpeg)
		rc = -ENOMEM;
	if (rc == 0)
		memcpy(out->jpeg, jpeg.data, jpeg.size);
	picture_finish(&fitted);
	buffer_finish(&jpeg);
	return rc;
}
