/* Any bytes as a patch group: refused, or a group that encodes and decodes to itself. */
#include "format/patch.h"

#include <stdlib.h>

#include "tests/fuzz/repack.h"

/* docs/patch.md: of the streams behind the indices, bytes a vertex; the last is of wide groups. */
static const uint8_t bytes_a_vertex[] = { 3, 3, 2, 1, 2, 1, 3 };
enum { PLACED = 0x80 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void decode(struct bytes object)
{
	struct patch_mesh patches[GROUP_PATCHES_MAX];
	uint32_t patch_count;
	struct buffer again;

	if (patch_group_decode(patches, &patch_count, object) < 0)
		return;
	buffer_init(&again, 64 << 20);
	if (patch_group_encode(&again, patches, patch_count) < 0)
		abort();
	buffer_finish(&again);
	for (uint32_t p = 0; p < patch_count; p++)
		patch_mesh_finish(&patches[p]);
}

static void put_stream(struct buffer *object, struct reader *in, size_t size)
{
	struct buffer frame;

	buffer_init(&frame, REPACK_BYTES_MAX);
	repack_put(&frame, in, size);
	buffer_put_u32(object, (uint32_t)frame.size);
	buffer_put(object, frame.data, frame.size);
	buffer_finish(&frame);
}

/* 'R', the header from its number of patches on, and what the streams hold, one after the other. */
static void pack_and_decode(const uint8_t *data, size_t size)
{
	size_t index_bytes = 0, vertices = 0, streams = sizeof(bytes_a_vertex) - 1;
	struct buffer object;
	struct reader in;
	uint8_t count;

	reader_init(&in, (struct bytes){ data + 1, size - 1 });
	buffer_init(&object, REPACK_BYTES_MAX);
	buffer_put(&object, "GPpg\2", 5);
	count = reader_u8(&in);
	buffer_put_u8(&object, count);
	for (int i = 0; i < 3; i++)
		buffer_put_u8(&object, reader_u8(&in));
	if (count & PLACED) {
		const uint8_t bytes = reader_u8(&in);

		streams += bytes == 3;
		buffer_put_u8(&object, bytes);
		for (int i = 0; i < 3; i++)
			buffer_put_u32(&object, reader_u32(&in));
	}
	for (uint8_t p = 0; p < (count & ~PLACED); p++) {
		const uint16_t of_patch = reader_u16(&in) % 2000, triangles = reader_u16(&in);
		const uint16_t of_indices = reader_u16(&in) % 4000;

		vertices += of_patch;
		index_bytes += of_indices;
		buffer_put_u16(&object, of_patch);
		buffer_put_u16(&object, triangles);
		buffer_put_u16(&object, of_indices);
	}
	put_stream(&object, &in, index_bytes);
	for (size_t i = 0; i < streams; i++)
		put_stream(&object, &in, bytes_a_vertex[i] * vertices);
	decode(buffer_bytes(&object));
	buffer_finish(&object);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	if (repack_is_raw(data, size))
		pack_and_decode(data, size);
	else
		decode((struct bytes){ data, size });
	return 0;
}
