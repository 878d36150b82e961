/* Walks a JPEG's segments to the one of EXIF, and the first directory in it. */
#include "curator/pages/exif_orientation.h"

#include <string.h>

enum { ORIENTATION = 0x0112, APP1 = 0xe1, SCAN = 0xda };

/* Numbers in a TIFF, in the byte order that its start names. */
struct tiff {
	struct bytes bytes;
	bool big_endian;
};

static uint32_t number(const struct tiff *tiff, size_t at, unsigned bytes)
{
	uint32_t value = 0;

	if (at > tiff->bytes.size || tiff->bytes.size - at < bytes)
		return 0;
	for (unsigned n = 0; n < bytes; n++)
		value = value << 8 | tiff->bytes.data[at + (tiff->big_endian ? n : bytes - 1 - n)];
	return value;
}

static unsigned orientation_of(struct bytes bytes)
{
	const struct tiff tiff = { bytes, bytes.size > 0 && bytes.data[0] == 'M' };
	const size_t directory = number(&tiff, 4, 4);
	const uint32_t entries = number(&tiff, directory, 2);

	for (uint32_t n = 0; n < entries; n++) {
		const size_t entry = directory + 2 + 12 * (size_t)n;
		uint32_t value;

		if (entry + 12 > bytes.size)
			return 1;
		if (number(&tiff, entry, 2) != ORIENTATION)
			continue;
		value = number(&tiff, entry + 8, 2);
		return value >= 1 && value <= 8 ? value : 1;
	}
	return 1;
}

unsigned exif_orientation(struct bytes jpeg)
{
	size_t at = 2;

	if (jpeg.size < 4 || jpeg.data[0] != 0xff || jpeg.data[1] != 0xd8)
		return 1;
	while (at + 4 <= jpeg.size && jpeg.data[at] == 0xff && jpeg.data[at + 1] != SCAN) {
		const uint8_t *segment = jpeg.data + at;
		const size_t bytes = (size_t)segment[2] << 8 | segment[3];

		if (bytes < 2 || bytes > jpeg.size - at - 2)
			return 1;
		if (segment[1] == APP1 && bytes > 8 && memcmp(segment + 4, "Exif\0\0", 6) == 0)
			return orientation_of((struct bytes){ segment + 10, bytes - 8 });
		at += 2 + bytes;
	}
	return 1;
}
