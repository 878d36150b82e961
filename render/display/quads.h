/* Textured quads over the scene: what ui drew, blended. Pixels are of the picture as the visitor
 * sees it (x right, y down); the panel's rotation is applied here, as it is in the scene. */
#ifndef GOPURA_RENDER_DISPLAY_QUADS_H
#define GOPURA_RENDER_DISPLAY_QUADS_H

#include <stdint.h>

#include "base/compiler.h"

enum { QUADS_TEXTURES_MAX = 129 };

struct quads;

/* Needs a current GLES2 context, as every call here. *out is NULL on failure. */
must_check int quads_create(struct quads **out);
void quads_destroy(struct quads *quads); /* NULL is fine */

/* Premultiplied, bytes B, G, R, A (as Cairo draws). Uploaded only where revision is another than
 * the texture has; id is below QUADS_TEXTURES_MAX. */
struct quads_pixels {
	uint32_t id, revision; /* revision is never 0 */
	int width_px, height_px, stride_bytes;
	const uint8_t *bgra;
};
must_check int quads_upload(struct quads *quads, const struct quads_pixels *pixels);

/* Its memory is given back, until it is uploaded again. */
void quads_drop(struct quads *quads, uint32_t id);
/* Every texture is uploaded again when it is next given: its id means something else now. */
void quads_forget(struct quads *quads);

/* Sets the state for drawing; width and height are of the picture, whose lower left corner lies at
 * shift_px of the framebuffer that is bound; rotation is the panel's. */
void quads_begin(struct quads *quads, const int shift_px[2], int width_px, int height_px,
		 int rotation_deg);
/* corners: top left, top right, bottom right, bottom left; source: left, top, right, bottom in
 * 0..1 of the texture. */
void quads_draw(struct quads *quads, uint32_t id, const float corners_px[4][2],
		const float source[4], float alpha);
void quads_end(struct quads *quads);

#endif
