/* A drawing surface in memory, as Cairo has it: 32 bits a pixel, premultiplied alpha, 0xAARRGGBB in
 * the machine's order (bytes B, G, R, A on our boards). GLES2 uploads it as GL_RGBA and swaps red
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

/* Transparent. -ENOMEM; -EINVAL for a side outside 1..BITMAP_SIDE_MOST_PX. *out is zeroed then. */
must_check int bitmap_init(struct bitmap *out, int width_px, int height_px);
void bitmap_finish(struct bitmap *bitmap); /* NULL and zeroed are fine */
/* A context on it that starts transparent; destroy it with bitmap_end before reading pixels. */
cairo_t *bitmap_begin(struct bitmap *bitmap);
void bitmap_end(struct bitmap *bitmap, cairo_t *context);

/* The picture scaled to exactly that size; where the proportions differ, its middle is kept and
 * the rest cut off. As bitmap_init. */
must_check int bitmap_from_picture(struct bitmap *out, const struct picture *picture, int width_px,
				   int height_px);

#endif
