/* Any bytes as a patch group: refused, or a group that encodes and decodes to itself. */
#include "format/patch.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct patch_mesh patches[GROUP_PATCHES_MOST];
	uint32_t patch_count;
	struct buffer again;

	if (patch_group_decode(patches, &patch_count, (struct bytes){ data, size }) < 0)
		return 0;
	buffer_init(&again, 64 << 20);
	if (patch_group_encode(&again, patches, patch_count) < 0)
		abort();
	buffer_finish(&again);
	for (uint32_t p = 0; p < patch_count; p++)
		patch_mesh_finish(&patches[p]);
	return 0;
}
