/* A tile. */
#include <errno.h>
#include <stdlib.h>

#include "format/samples.h"
#include "format/tile.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static uint8_t rgb[SAMPLE_IMAGE_PX * SAMPLE_IMAGE_PX * 3];
	int rc = tile_decode(rgb, SAMPLE_IMAGE_PX, (struct bytes){ data, size });

	if (rc != 0 && rc != -EBADMSG)
		abort(); /* a kiosk asks again for what memory was lacking for */
	return 0;
}
