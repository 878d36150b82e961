/* Reads the bytes of a tile that samples_store_next names. */
#ifndef GOPURA_TESTS_PIPELINE_SAMPLES_TILE_OF_H
#define GOPURA_TESTS_PIPELINE_SAMPLES_TILE_OF_H

#include <fcntl.h>
#include <unistd.h>

#include "pipeline/samples/sample_store.h"
#include "tests/check.h"

/* Borrowed until the next call. */
static inline struct bytes tile_of(const struct sample_face *face, uint32_t tile)
{
	static uint8_t bytes[1 << 20];
	int fd = open(face->path, O_RDONLY | O_CLOEXEC);

	CHECK(fd >= 0 && face->sizes[tile] <= sizeof(bytes));
	CHECK(bytes_read_at(fd, bytes, face->sizes[tile], face->offsets[tile]) == 0);
	close(fd);
	CHECK(hash_equal(hash_of((struct bytes){ bytes, face->sizes[tile] }), face->hashes[tile]));
	return (struct bytes){ bytes, face->sizes[tile] };
}

#endif
