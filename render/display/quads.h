/* Draws textured quads over the scene: the bitmaps of ui, blended. Pixels are those of the picture
 * as the visitor sees it (x right, y down); the panel's rotation is applied here, as in the
 * scene. */
#ifndef GOPURA_RENDER_DISPLAY_QUADS_H
#define GOPURA_RENDER_DISPLAY_QUADS_H

#include <stdint.h>

#include "base/compiler.h"

enum { QUADS_TEXTURES_MAX = 137 };

struct quads;

/* Creates the program. All calls here need a current GLES2 context. The caller owns *out; it is
 * NULL on failure. -ENOMEM, or as gl_program_build. */
must_check int quads_create(struct quads **out);
void quads_destroy(struct quads *quads); /* Frees the program and all textures. NULL is fine. */

/* A bitmap, borrowed for the call: premultiplied alpha, bytes B, G, R, A (as Cairo draws). id is
 * below QUADS_TEXTURES_MAX. A bitmap is uploaded only if its revision differs from that of the
 * texture. */
struct quads_pixels {
	uint32_t id, revision; /* revision is never 0 */
	int width_px, height_px, stride_bytes;
	const uint8_t *bgra;
};
/* Uploads a bitmap as the texture of its id. -EINVAL: the id or the size is not allowed. -ENOMEM,
 * -EIO. */
must_check int quads_upload(struct quads *quads, const struct quads_pixels *pixels);

/* Frees the memory of a texture until it is uploaded again. */
void quads_drop(struct quads *quads, uint32_t id);
/* Makes every texture be uploaded again when next given: its id now means something else. */
void quads_forget(struct quads *quads);

/* Sets the GL state for drawing. width_px and height_px are those of the picture, whose lower left
 * corner lies at shift_px in the bound framebuffer. rotation_deg is the panel's: 0, 90, 180 or 270
 * clockwise. */
void quads_begin(struct quads *quads, const int shift_px[2], int width_px, int height_px,
		 int rotation_deg);
/* Draws one quad between quads_begin and quads_end. corners_px: top left, top right, bottom right,
 * bottom left. source: left, top, right, bottom, 0..1 of the texture. alpha: 0..1. A texture that
 * was never uploaded draws nothing. */
void quads_draw(struct quads *quads, uint32_t id, const float corners_px[4][2],
		const float source[4], float alpha);
/* Restores the GL state that the scene expects: no blending. */
void quads_end(struct quads *quads);

#endif
