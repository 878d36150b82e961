/* A Cairo drawing surface in memory: 32 bits per pixel, premultiplied alpha, 0xAARRGGBB in the
 * machine's byte order (bytes B, G, R, A on our boards). GLES2 uploads it as GL_RGBA and swaps red
 * and blue in the shader. */
#ifndef GOPURA_UI_BITMAP_H
#define GOPURA_UI_BITMAP_H

#include <cairo.h>

#include "base/compiler.h"
#include "format/picture.h"

struct bitmap {
	int width_px, height_px, stride_bytes;
	unsigned char *pixels; /* borrowed from the surface */
	cairo_surface_t *surface;
};

enum { BITMAP_SIDE_MOST_PX = 8192 };

/* Makes a transparent bitmap, owned by the caller. Returns -ENOMEM, or -EINVAL for a side outside
 * 1..BITMAP_SIDE_MOST_PX. *out is zeroed on failure. */
must_check int bitmap_init(struct bitmap *out, int width_px, int height_px);
void bitmap_finish(struct bitmap *bitmap); /* NULL and zeroed are fine */
/* Clears the bitmap and returns a drawing context. End it with bitmap_end before reading pixels. */
cairo_t *bitmap_begin(struct bitmap *bitmap);
/* Destroys the context and flushes the surface. */
void bitmap_end(struct bitmap *bitmap, cairo_t *context);

/* Makes a bitmap of exactly that size from a picture. If the proportions differ, the middle of the
 * picture is kept and the rest is cut off. Returns the errors of bitmap_init. */
must_check int bitmap_from_picture(struct bitmap *out, const struct picture *picture, int width_px,
				   int height_px);

#endif
