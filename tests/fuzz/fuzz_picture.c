/* A PNG or JPEG file. */
#include "format/picture.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { SIDE_SMALL_PX = 1024 };

static bool is_small_png(const uint8_t *data, size_t size)
{
	static const uint8_t before[] = { 0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n',
					  0,    0,   0,   13,  'I',  'H',  'D',  'R' };
	uint32_t side_px[2] = { 0 };

	if (size < sizeof(before) + 8 || memcmp(data, before, sizeof(before)) != 0)
		return false;
	for (int i = 0; i < 8; i++)
		side_px[i / 4] = side_px[i / 4] << 8 | data[sizeof(before) + i];
	return side_px[0] <= SIDE_SMALL_PX && side_px[1] <= SIDE_SMALL_PX;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct picture picture;
	int rc = picture_decode(&picture, (struct bytes){ data, size });

	if (rc == -ENOMEM && is_small_png(data, size))
		abort(); /* damage, by libpng's words */
	picture_finish(&picture);
	return 0;
}
