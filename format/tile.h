/* A tile: SAMPLE_IMAGE_PX square, 8-bit sRGB, as an abbreviated JPEG (its tables are in the samples
 * page). Quality and chroma sampling are chosen by the encoder; the decoder reads any that is
 * sequential, coded by arithmetic (as ours are) or by Huffman. */
#ifndef GOPURA_FORMAT_TILE_H
#define GOPURA_FORMAT_TILE_H

#include <stdbool.h>

#include "base/bytes.h"

struct tile_codec; /* holds libjpeg's state and the shared tables; one thread at a time */

/* For encoding. quality 1..100; chroma_full: 4:4:4, else 4:2:0. */
must_check int tile_encoder_create(struct tile_codec **out, int quality, bool chroma_full);
/* Appends the tables-only stream that decoders need. */
must_check int tile_encoder_tables(struct tile_codec *codec, struct buffer *out);
/* rgb: side_px * side_px * 3 bytes, row 0 on top. Appends one tile. */
must_check int tile_encode(struct tile_codec *codec, struct buffer *out, const uint8_t *rgb,
			   uint32_t side_px);

/* For decoding. -EBADMSG: not a tables-only stream. */
must_check int tile_decoder_create(struct tile_codec **out, struct bytes tables);
/* Into rgb (side_px * side_px * 3 bytes). -EBADMSG: damaged, or not side_px square. */
must_check int tile_decode(struct tile_codec *codec, uint8_t *rgb, uint32_t side_px,
			   struct bytes object);
void tile_codec_destroy(struct tile_codec *codec);

#endif
