/* A texture in square fragments, each with a JPEG quality of its own, written as one ordinary JPEG
 * file (Cheng and Boulanger, "Scale-Space 3D TexMesh Simplification", 2004).
 *
 * A JPEG file has one table of quantization steps. The picture is compressed once with the steps of
 * the best quality of its fragments, and colours at half resolution (4:2:0). To give a fragment
 * less, its coefficients are rounded to coarser steps: those multiples of the best quality's that
 * are nearest to the steps of its own quality. Most become zero, which takes hardly any bytes; but
 * one that does not still takes the bits of a number of fine steps, so the best quality should not
 * be better than is needed. Any JPEG reader shows the result. The file is progressive, since only
 * progressive files merge the ends of empty blocks into one code.
 *
 * One thread. Logs the errors of libjpeg. */
#ifndef GOPURA_PIPELINE_TEXMESH_FRAGMENT_JPEG_H
#define GOPURA_PIPELINE_TEXMESH_FRAGMENT_JPEG_H

#include <stdbool.h>
#include <stdint.h>

#include "base/bytes.h"
#include "base/compiler.h"

enum {
	FRAGMENT_JPEG_QUALITY_MOST = 95, /* better ones take many bytes for nothing to be seen */
	FRAGMENT_JPEG_SIDE_MOST_PX = 16384,
	/* The side of a fragment is a multiple of it: that of an MCU, which has 2 x 2 blocks of
	 * brightness and one of each colour. */
	FRAGMENT_JPEG_UNIT_PX = 16,
};

struct fragment_jpeg; /* private to fragment_jpeg.c; keeps 3 bytes for each pixel */

/* Compresses a picture and estimates the bytes of each fragment at each quality. rgb: 3 bytes for a
 * pixel, row 0 on top; borrowed for the call only. Sides: 1..FRAGMENT_JPEG_SIDE_MOST_PX.
 * fragment_px: side of a fragment, a multiple of FRAGMENT_JPEG_UNIT_PX; the fragments of the last
 * column and row may be smaller. used: for each fragment, row by row, whether a part of it is
 * shown; NULL: all; copied. A fragment that is not used has one colour for each component, that of
 * the block before it, and takes next to no bytes. libjpeg's smooth upsampling of colours takes a
 * quarter of the outermost pixel from the neighbour, so keep what is shown a pixel or two away from
 * fragments that are not used.
 *
 * best: the quality that no fragment is above, 1..FRAGMENT_JPEG_QUALITY_MOST; it is what higher
 * ones are taken for.
 *
 * *out is owned by the caller; on failure it is NULL. -EINVAL: a size, or best; -ENOMEM; -EIO:
 * libjpeg. */
must_check int fragment_jpeg_create(struct fragment_jpeg **out, const uint8_t *rgb,
				    uint32_t width_px, uint32_t height_px, uint32_t fragment_px,
				    const bool *used, uint8_t best);
void fragment_jpeg_destroy(struct fragment_jpeg *jpeg); /* NULL is fine */

/* Returns the number of fragments: columns * rows. */
uint32_t fragment_jpeg_count(const struct fragment_jpeg *jpeg);

/* Returns about how many bytes a fragment adds to the file at a quality of 1..best (0: as 1;
 * above: as best). Never fewer at a higher quality. Looks it up in a table.
 *
 * The sum over all fragments, against files of two textures with fragments of 64 px: within 6 % if
 * all have one quality; 9 to 11 % too few if each has a random one, since they share one table of
 * Huffman codes. The headers, up to 700 bytes, come on top. */
uint32_t fragment_jpeg_bytes(const struct fragment_jpeg *jpeg, uint32_t fragment, uint8_t quality);

/* Appends the file to out, each fragment at its quality (as above; fragment_jpeg_count numbers,
 * borrowed). May be called any number of times: all start from the coefficients of the best
 * quality. Needs another 3 bytes for each pixel meanwhile. -ENOMEM; -EFBIG: past the ceiling of
 * out; -EIO: libjpeg. On failure out has its old size. */
must_check int fragment_jpeg_write(const struct fragment_jpeg *jpeg, const uint8_t *qualities,
				   struct buffer *out);

#endif
