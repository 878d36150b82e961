/* Any bytes as the payload of a hierarchy page: refused, or a structure that keeps every rule. */
#include "format/hierarchy.h"

#include <stdlib.h>

#include "tests/fuzz/repack.h"

/* docs/hierarchy.md: columns of a group and of a patch. */
enum { GROUP_BYTES = 21, PATCH_BYTES = 40, COUNT_MAX = 64 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void decode(struct bytes payload)
{
	struct hierarchy hierarchy;

	if (hierarchy_decode(&hierarchy, payload) < 0)
		return;
	if (hierarchy_check(&hierarchy) < 0)
		abort();
	hierarchy_finish(&hierarchy);
}

/* 'R', the numbers of groups and of patches, a byte each, and the columns. */
static void pack_and_decode(const uint8_t *data, size_t size)
{
	struct buffer payload;
	struct reader in;
	uint32_t groups, patches;

	reader_init(&in, (struct bytes){ data + 1, size - 1 });
	groups = reader_u8(&in) % COUNT_MAX;
	patches = reader_u8(&in) % COUNT_MAX;
	buffer_init(&payload, REPACK_BYTES_MAX);
	buffer_put_u8(&payload, 1);
	buffer_put_u32(&payload, groups);
	buffer_put_u32(&payload, patches);
	repack_put(&payload, &in, groups * GROUP_BYTES + patches * PATCH_BYTES);
	decode(buffer_bytes(&payload));
	buffer_finish(&payload);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	if (repack_is_raw(data, size))
		pack_and_decode(data, size);
	else
		decode((struct bytes){ data, size });
	return 0;
}
