/* A tile: SAMPLE_IMAGE_PX square, 8-bit sRGB, one lossy WebP picture without its RIFF container (a
 * VP8 key frame, RFC 6386). The container's 20 bytes carry no information and are a hundredth of a
 * tile. docs/samples.md has the figures behind this choice. Decoding needs only the object. */
#ifndef GOPURA_FORMAT_TILE_H
#define GOPURA_FORMAT_TILE_H

#include "base/bytes.h"

/* How long the encoder searches for fewer bytes. */
enum tile_effort {
	TILE_THOROUGH,
	TILE_QUICK /* in about half of the time; 3 % more bytes */
};

/* Appends one tile. rgb is side_px * side_px * 3 bytes, row 0 on top; quality is 1..100. Returns
 * -EINVAL for a side or quality out of range, -ENOMEM or the error of out. */
must_check int tile_encode(struct buffer *out, const uint8_t *rgb, uint32_t side_px, int quality,
			   enum tile_effort effort);

/* Decodes into rgb (side_px * side_px * 3 bytes). Returns -EBADMSG if the object is damaged or not
 * side_px square, -EINVAL if side_px is out of range, -ENOMEM. */
must_check int tile_decode(uint8_t *rgb, uint32_t side_px, struct bytes object);

#endif
