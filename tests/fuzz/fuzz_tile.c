/* A tile. */
#include "format/samples.h"
#include "format/tile.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static uint8_t rgb[SAMPLE_IMAGE_PX * SAMPLE_IMAGE_PX * 3];

	(void)!tile_decode(rgb, SAMPLE_IMAGE_PX, (struct bytes){ data, size });
	return 0;
}
