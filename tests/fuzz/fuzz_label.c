/* Any bytes as labels of a patch group: refused, or labels that encode and decode to themselves and
 * answer at every place. */
#include "format/label.h"

#include <stdlib.h>

#include "tests/fuzz/repack.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void ask(const struct label_group *group)
{
	for (uint32_t p = 0; p < group->patch_count; p++)
		for (uint32_t t = 0; t <= group->patches[p].triangle_count; t += 7)
			for (int i = 0; i <= 4; i++) {
				int part = label_part_at(group, p, t, (float)i / 4,
							 (float)(4 - i) / 8);

				if (part >= (int)group->part_count)
					abort();
			}
}

static void decode(const uint8_t *data, size_t size)
{
	struct label_group group, back;
	struct buffer again;
	uint32_t *children;

	/* A page that says so many groups, of any number of children. */
	for (uint32_t count = 0; size > 4 && data[2] + data[3] + data[4] == 0 && count < 9; count++)
		if (label_page_decode(&children, data[1], count, (struct bytes){ data, size }) == 0)
			free(children);
	if (label_group_decode(&group, (struct bytes){ data, size }) < 0)
		return;
	ask(&group);
	buffer_init(&again, 64 << 20);
	if (label_group_encode(&again, &group) < 0 ||
	    label_group_decode(&back, buffer_bytes(&again)) < 0 ||
	    label_group_bytes(&back) != label_group_bytes(&group))
		abort();
	buffer_finish(&again);
	label_group_finish(&group);
	label_group_finish(&back);
}

/* 'R', the number of patches, and what the frame holds. */
static void pack_and_decode(const uint8_t *data, size_t size)
{
	struct buffer object;
	struct reader in;

	reader_init(&in, (struct bytes){ data + 1, size - 1 });
	buffer_init(&object, REPACK_BYTES_MAX);
	buffer_put(&object, "GPlb\1", 5);
	buffer_put_u8(&object, reader_u8(&in));
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
