/* Any bytes as scenery: refused, or scenery that encodes and decodes to itself. */
#include "format/scenery_code.h"
#include "format/scenery_texture_code.h"

#include <stdlib.h>

#include "tests/fuzz/repack.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void decode(const uint8_t *data, size_t size)
{
	struct scenery scenery, back;
	struct buffer once, twice;

	if (scenery_decode(&scenery, (struct bytes){ data, size }) < 0)
		return;
	if (scenery_decode_textures(&scenery) < 0 && scenery.texture_count == 0)
		abort();
	buffer_init(&once, 64 << 20);
	buffer_init(&twice, 64 << 20);
	if (scenery_encode(&once, &scenery) < 0 || scenery_decode(&back, buffer_bytes(&once)) < 0 ||
	    scenery_encode(&twice, &back) < 0 || once.size != twice.size ||
	    memcmp(once.data, twice.data, once.size) != 0)
		abort();
	buffer_finish(&once);
	buffer_finish(&twice);
	scenery_finish(&scenery);
	scenery_finish(&back);
}

/* 'R', and what the frame holds; the first byte chooses among the versions. */
static void pack_and_decode(const uint8_t *data, size_t size)
{
	struct buffer object;
	struct reader in;

	if (size < 2)
		return;
	reader_init(&in, (struct bytes){ data + 2, size - 2 });
	buffer_init(&object, REPACK_BYTES_MAX);
	buffer_put(&object, "GPsy", 4);
	buffer_put_u8(&object, data[1] & 1    ? 1
			       : data[1] & 8  ? 5
			       : data[1] & 4  ? 4
			       : data[1] & 2  ? 3
			       : data[1] & 16 ? 6
					      : 2);
	buffer_put_u32(&object, (uint32_t)reader_left(&in));
	repack_put(&object, &in, reader_left(&in));
	decode(object.data, object.size);
	buffer_finish(&object);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	if (repack_is_raw(data, size))
		pack_and_decode(data, size);
	else
		decode(data, size);
	return 0;
}
