/* Formats that hold zstd frames hide what is in them from a fuzzer: a changed byte in a frame
 * seldom gives a frame. So their targets take a second kind of input, which begins with 'R': the
 * same with the content as it is, packed here. */
#ifndef GOPURA_TESTS_FUZZ_REPACK_H
#define GOPURA_TESTS_FUZZ_REPACK_H

#include <stdlib.h>
#include <string.h>

#include <zstd.h>

#include "base/bytes.h"

enum { REPACK_RAW = 'R', REPACK_BYTES_MAX = 1 << 20 };

static inline bool repack_is_raw(const uint8_t *data, size_t size)
{
	return size > 0 && data[0] == REPACK_RAW;
}

/* A frame of the next size bytes of in, zeros where it has fewer. */
static inline void repack_put(struct buffer *out, struct reader *in, size_t size)
{
	uint8_t *raw = calloc(1, size + 1);
	const size_t room = ZSTD_compressBound(size);
	uint8_t *packed = malloc(room);
	const size_t there = size < reader_left(in) ? size : reader_left(in);
	const struct bytes from = reader_bytes(in, there);
	size_t packed_bytes;

	if (!raw || !packed)
		abort();
	if (from.size)
		memcpy(raw, from.data, from.size);
	packed_bytes = ZSTD_compress(packed, room, raw, size, 1);
	if (ZSTD_isError(packed_bytes))
		abort();
	buffer_put(out, packed, packed_bytes);
	free(packed);
	free(raw);
}

#endif
