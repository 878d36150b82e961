/* Any bytes as labels of a patch group: refused, or labels that encode and decode to themselves and
 * answer at every place. */
#include "format/label.h"

#include <stdlib.h>

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

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct label_group group, back;
	struct buffer again;
	uint32_t *children;

	/* A page that says so many groups, of any number of children. */
	for (uint32_t count = 0; size > 4 && data[2] + data[3] + data[4] == 0 && count < 9; count++)
		if (label_page_decode(&children, data[1], count, (struct bytes){ data, size }) == 0)
			free(children);
	if (label_group_decode(&group, (struct bytes){ data, size }) < 0)
		return 0;
	ask(&group);
	buffer_init(&again, 64 << 20);
	if (label_group_encode(&again, &group) < 0 ||
	    label_group_decode(&back, buffer_bytes(&again)) < 0 ||
	    label_group_bytes(&back) != label_group_bytes(&group))
		abort();
	buffer_finish(&again);
	label_group_finish(&group);
	label_group_finish(&back);
	return 0;
}
