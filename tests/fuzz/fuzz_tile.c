/* u16 size of the tables, the tables, then a tile of 136 pixels. */
#include "format/samples.h"
#include "format/tile.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static uint8_t rgb[SAMPLE_IMAGE_PX * SAMPLE_IMAGE_PX * 3];
	struct tile_codec *codec;
	size_t tables;

	if (size < 2)
		return 0;
	tables = data[0] | (size_t)data[1] << 8;
	if (tables > size - 2)
		return 0;
	if (tile_decoder_create(&codec, (struct bytes){ data + 2, tables }) < 0)
		return 0;
	(void)!tile_decode(codec, rgb, SAMPLE_IMAGE_PX,
			   (struct bytes){ data + 2 + tables, size - 2 - tables });
	tile_codec_destroy(codec);
	return 0;
}
