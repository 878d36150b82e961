/* A tile: SAMPLE_IMAGE_PX square, 8-bit sRGB, as one lossy WebP picture without its RIFF container
 * (a VP8 key frame, RFC 6386): 20 bytes that say nothing, a hundredth of a tile. docs/samples.md
 * has the figures that chose it. Decoding needs nothing but the object. */
#ifndef GOPURA_FORMAT_TILE_H
#define GOPURA_FORMAT_TILE_H

#include "base/bytes.h"

/* rgb: side_px * side_px * 3 bytes, row 0 on top; quality 1..100. Appends one tile. -EINVAL: no
 * such side or quality; -ENOMEM. */
must_check int tile_encode(struct buffer *out, const uint8_t *rgb, uint32_t side_px, int quality);

/* Into rgb (side_px * side_px * 3 bytes). -EBADMSG: damaged, or not side_px square. */
must_check int tile_decode(uint8_t *rgb, uint32_t side_px, struct bytes object);

#endif
