/* Where libjpeg writes a file: to the end of a buffer. Its own destination in memory frees what it
 * outgrew before it says where the new one is, so after an error nobody knows what to free. */
#ifndef GOPURA_FORMAT_JPEG_TO_BUFFER_H
#define GOPURA_FORMAT_JPEG_TO_BUFFER_H

#include <stdio.h>

#include <jpeglib.h>

#include "base/bytes.h"

struct jpeg_to_buffer {
	struct jpeg_destination_mgr manager;
	struct buffer *out;
	uint8_t chunk[1 << 14];
};

/* Makes the codec write to out, which keeps its failures (buffer.error); both are borrowed until
 * the codec is destroyed. */
void jpeg_to_buffer(struct jpeg_to_buffer *to, j_compress_ptr codec, struct buffer *out);

#endif
