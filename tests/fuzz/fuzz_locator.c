/* A locator as it came, and the same bytes sealed with the right hash, so that the checks behind
 * the seal are met too. */
#include <stdlib.h>
#include <string.h>

#include "format/locator.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void decode(struct bytes file)
{
	struct locator locator;

	if (locator_decode(&locator, file) < 0)
		return;
	for (uint32_t i = 0; i < locator.block_count; i++)
		if (locator_find(&locator, locator.blocks[i].page) != &locator.blocks[i])
			abort();
	locator_finish(&locator);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct hash seal;
	uint8_t *copy;

	decode((struct bytes){ data, size });
	if (size < HASH_BYTES)
		return 0;
	copy = malloc(size);
	if (!copy)
		return 0;
	memcpy(copy, data, size);
	seal = hash_of((struct bytes){ copy, size - HASH_BYTES });
	memcpy(copy + size - HASH_BYTES, seal.bytes, HASH_BYTES);
	decode((struct bytes){ copy, size });
	free(copy);
	return 0;
}
