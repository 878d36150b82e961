/* A PNG or JPEG file. */
#include "format/picture.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct picture picture;

	(void)!picture_decode(&picture, (struct bytes){ data, size });
	picture_finish(&picture);
	return 0;
}
