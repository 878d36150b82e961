/* Whole pictures (PNG, JPEG) to and from pixels in memory: page pictures, scan textures, captures.
 * Tiles have their own codec: format/tile.h. */
#ifndef GOPURA_FORMAT_PICTURE_H
#define GOPURA_FORMAT_PICTURE_H

#include "base/bytes.h"

enum {
	PICTURE_SIDE_MOST_PX = 16384,
	PICTURE_PIXELS_MAX = 1 << 28,
	/* For pictures of pages and cards: a terminal decodes these between two frames. */
	PICTURE_PAGE_SIDE_MOST_PX = 4096,
};

/* sRGB with straight alpha, 4 bytes per pixel, row 0 on top, no padding between rows. */
struct picture {
	uint32_t width, height;
	uint8_t *rgba; /* owned */
};

/* Decodes a PNG or JPEG file, recognised by its first bytes. Returns -EBADMSG if it is damaged,
 * truncated or neither; -EFBIG past the limits above; -ENOMEM. The caller ends *out with
 * picture_finish(); it is zeroed on failure. */
must_check int picture_decode(struct picture *out, struct bytes file);
/* As picture_decode, for a picture of a page: returns -EFBIG past PICTURE_PAGE_SIDE_MOST_PX, before
 * any pixel is decoded or memory for it is allocated. */
must_check int picture_decode_for_page(struct picture *out, struct bytes file);
/* Appends the file. Returns -ENOMEM, or -EFBIG past the buffer's ceiling. */
must_check int picture_encode_png(struct buffer *out, const struct picture *picture);
/* As above. quality is 1..100; alpha is dropped. */
must_check int picture_encode_jpeg(struct buffer *out, const struct picture *picture, int quality);
/* The same with the colours as fine as the brightness, for pictures that are numbers. */
must_check int picture_encode_fine_jpeg(struct buffer *out, const struct picture *picture,
					int quality);
void picture_finish(struct picture *picture); /* NULL and zeroed are fine */

#endif
