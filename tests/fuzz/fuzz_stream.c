/* Any bytes as a streaming mesh, with the checks of its header and blocks corrected: refused, or
 * decoded; what was decoded can be undone and applied again. */
#include "format/stream.h"

#include <stdlib.h>
#include <string.h>

#include "format/hash.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { HEADER_BYTES = 29, BLOCK_HEADER_BYTES = 8, CHECK_BYTES = 8 };

static void correct_checks(uint8_t *bytes, size_t size)
{
	size_t at = 0, part = HEADER_BYTES;

	while (part <= size - at && CHECK_BYTES <= size - at - part) {
		struct hash hash = hash_of((struct bytes){ bytes + at, part });

		memcpy(bytes + at + part, hash.bytes, CHECK_BYTES);
		at += part + CHECK_BYTES;
		if (size - at < BLOCK_HEADER_BYTES)
			return;
		part = BLOCK_HEADER_BYTES + ((size_t)bytes[at] | (size_t)bytes[at + 1] << 8 |
					     (size_t)bytes[at + 2] << 16 |
					     (size_t)bytes[at + 3] << 24);
	}
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	uint8_t *bytes = malloc(size + 1);
	struct stream_decoder *decoder;
	uint32_t vertices, triangles;

	if (!bytes || stream_decoder_create(&decoder) < 0)
		abort();
	if (size)
		memcpy(bytes, data, size);
	correct_checks(bytes, size);
	for (size_t part = size / 2;; part = size) {
		int rc = stream_decoder_advance(decoder, (struct bytes){ bytes, part });

		if (rc < 0 || part == size)
			break;
	}
	vertices = stream_decoder_mesh(decoder)->vertex_count;
	triangles = stream_decoder_mesh(decoder)->triangle_count;
	stream_decoder_show(decoder, 0);
	stream_decoder_show(decoder, UINT32_MAX);
	if (stream_decoder_mesh(decoder)->vertex_count != vertices ||
	    stream_decoder_mesh(decoder)->triangle_count != triangles)
		abort();
	stream_decoder_destroy(decoder);
	free(bytes);
	return 0;
}
