/* Decoders of other people's libraries that tell a lack of memory from damage: an object that is
 * damaged is not asked for again, one that memory was lacking for is. */
#ifndef GOPURA_FORMAT_UNPACK_H
#define GOPURA_FORMAT_UNPACK_H

#include <stdbool.h>

#include "base/bytes.h"

/* Returns whether packed is one frame of zstd with nothing behind it, which says that it holds so
 * many bytes. To be asked before there is room for them. */
bool unpack_zstd_fits(size_t bytes, struct bytes packed);
/* Decompresses a frame of zstd into `bytes` bytes. -EBADMSG: it is damaged, or has another size;
 * -ENOMEM. */
must_check int unpack_zstd(uint8_t *out, size_t bytes, struct bytes packed);
/* Decodes a WebP picture, with its container or without, whose size the caller knows: 8-bit sRGB,
 * 3 bytes a pixel, or 4 with straight alpha, row 0 on top, no padding. -EBADMSG: it is damaged, or
 * larger than `bytes`; -ENOMEM. */
must_check int unpack_webp(uint8_t *out, size_t bytes, uint32_t width_px, bool alpha,
			   struct bytes file);

#endif
