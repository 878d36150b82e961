/* Creates Cairo image surfaces and fills them from decoded pictures. */
#include "ui/bitmap.h"

#include <errno.h>
#include <string.h>

int bitmap_init(struct bitmap *out, int width_px, int height_px)
{
	memset(out, 0, sizeof(*out));
	if (width_px < 1 || height_px < 1 || width_px > BITMAP_SIDE_MOST_PX ||
	    height_px > BITMAP_SIDE_MOST_PX)
		return -EINVAL;
	out->surface = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, width_px, height_px);
	if (cairo_surface_status(out->surface) != CAIRO_STATUS_SUCCESS) {
		bitmap_finish(out);
		return -ENOMEM;
	}
	out->width_px = width_px;
	out->height_px = height_px;
	out->stride_bytes = cairo_image_surface_get_stride(out->surface);
	out->pixels = cairo_image_surface_get_data(out->surface);
	return 0;
}

void bitmap_finish(struct bitmap *bitmap)
{
	if (!bitmap)
		return;
	if (bitmap->surface)
		cairo_surface_destroy(bitmap->surface);
	memset(bitmap, 0, sizeof(*bitmap));
}

cairo_t *bitmap_begin(struct bitmap *bitmap)
{
	cairo_t *context = cairo_create(bitmap->surface);

	cairo_set_operator(context, CAIRO_OPERATOR_CLEAR);
	cairo_paint(context);
	cairo_set_operator(context, CAIRO_OPERATOR_OVER);
	return context;
}

void bitmap_end(struct bitmap *bitmap, cairo_t *context)
{
	cairo_destroy(context);
	cairo_surface_flush(bitmap->surface);
}

/* Converts sRGB with straight alpha to premultiplied words. */
static void premultiply(struct bitmap *out, const struct picture *picture)
{
	for (uint32_t y = 0; y < picture->height; y++) {
		const uint8_t *from = picture->rgba + (size_t)y * picture->width * 4;
		uint32_t *to = (uint32_t *)(void *)(out->pixels + (size_t)y * out->stride_bytes);

		for (uint32_t x = 0; x < picture->width; x++, from += 4) {
			uint32_t alpha = from[3];
			uint32_t red = (from[0] * alpha + 127) / 255;
			uint32_t green = (from[1] * alpha + 127) / 255;
			uint32_t blue = (from[2] * alpha + 127) / 255;

			to[x] = alpha << 24 | red << 16 | green << 8 | blue;
		}
	}
	cairo_surface_mark_dirty(out->surface);
}

int bitmap_from_picture(struct bitmap *out, const struct picture *picture, int width_px,
			int height_px)
{
	struct bitmap whole;
	double scale_x, scale_y, scale;
	cairo_t *context;
	int rc;

	memset(out, 0, sizeof(*out));
	rc = bitmap_init(&whole, (int)picture->width, (int)picture->height);
	if (rc < 0)
		return rc;
	rc = bitmap_init(out, width_px, height_px);
	if (rc == 0) {
		premultiply(&whole, picture);
		scale_x = (double)width_px / whole.width_px;
		scale_y = (double)height_px / whole.height_px;
		scale = scale_x > scale_y ? scale_x : scale_y;
		context = bitmap_begin(out);
		cairo_translate(context, (width_px - whole.width_px * scale) / 2,
				(height_px - whole.height_px * scale) / 2);
		cairo_scale(context, scale, scale);
		cairo_set_source_surface(context, whole.surface, 0, 0);
		cairo_pattern_set_filter(cairo_get_source(context), CAIRO_FILTER_GOOD);
		cairo_pattern_set_extend(cairo_get_source(context), CAIRO_EXTEND_PAD);
		cairo_paint(context);
		bitmap_end(out, context);
	}
	bitmap_finish(&whole);
	return rc;
}
