#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "format/samples.h"
#include "format/tile.h"
#include "tests/check.h"

enum { SIDE = SAMPLE_IMAGE_PX, PIXELS_BYTES = SIDE * SIDE * 3 };

static uint8_t *smooth_picture(void)
{
	uint8_t *rgb = malloc(PIXELS_BYTES);

	for (int i = 0; i < PIXELS_BYTES; i++) {
		int x = i / 3 % SIDE, y = i / 3 / SIDE, c = i % 3;

		rgb[i] = (uint8_t)(128 + 60 * sin(x * 0.07 + c) + 60 * cos(y * 0.05 - c));
	}
	return rgb;
}

static double psnr(const uint8_t *a, const uint8_t *b)
{
	double sum = 0;

	for (int i = 0; i < PIXELS_BYTES; i++)
		sum += (a[i] - b[i]) * (a[i] - b[i]);
	return 10 * log10(255.0 * 255.0 * PIXELS_BYTES / (sum + 1e-9));
}

static void encode(struct buffer *tables, struct buffer *tile, const uint8_t *rgb, bool chroma_full)
{
	struct tile_codec *codec;

	buffer_init(tables, 10000);
	buffer_init(tile, 1000000);
	CHECK(tile_encoder_create(&codec, 75, chroma_full) == 0);
	CHECK(tile_encoder_tables(codec, tables) == 0);
	CHECK(tile_encode(codec, tile, rgb, SIDE) == 0);
	tile_codec_destroy(codec);
}

static void gives_back_the_picture(void **state)
{
	uint8_t *rgb = smooth_picture(), *back = malloc(PIXELS_BYTES);

	(void)state;
	for (int chroma_full = 0; chroma_full < 2; chroma_full++) {
		struct buffer tables, tile;
		struct tile_codec *codec;

		encode(&tables, &tile, rgb, chroma_full);
		CHECK(tables.size > 100 && tables.size < 1000);
		CHECK(tile_decoder_create(&codec, buffer_bytes(&tables)) == 0);
		for (int n = 0; n < 2; n++) {
			memset(back, 0, PIXELS_BYTES);
			CHECK(tile_decode(codec, back, SIDE, buffer_bytes(&tile)) == 0);
			CHECK(psnr(rgb, back) > 38);
		}
		CHECK(tile_decode(codec, back, SIDE / 2, buffer_bytes(&tile)) == -EBADMSG);
		tile_codec_destroy(codec);
		buffer_finish(&tables);
		buffer_finish(&tile);
	}
	free(rgb);
	free(back);
}

static void is_the_same_bytes_every_time(void **state)
{
	uint8_t *rgb = smooth_picture();
	struct buffer tables, tile, again;
	struct tile_codec *codec;

	(void)state;
	encode(&tables, &tile, rgb, false);
	buffer_init(&again, 1000000);
	CHECK(tile_encoder_create(&codec, 75, false) == 0);
	CHECK(tile_encode(codec, &again, rgb, SIDE) == 0); /* tables never asked for */
	CHECK(again.size == tile.size && memcmp(again.data, tile.data, tile.size) == 0);
	buffer_clear(&again);
	CHECK(tile_encode(codec, &again, rgb, SIDE) == 0);
	CHECK(again.size == tile.size && memcmp(again.data, tile.data, tile.size) == 0);
	tile_codec_destroy(codec);
	buffer_finish(&tables);
	buffer_finish(&tile);
	buffer_finish(&again);
	free(rgb);
}

static void refuses_every_truncation(void **state)
{
	uint8_t *rgb = smooth_picture(), *back = malloc(PIXELS_BYTES);
	struct buffer tables, tile;
	struct tile_codec *codec;

	(void)state;
	encode(&tables, &tile, rgb, true);
	for (size_t n = 0; n < tables.size; n++) {
		uint8_t *exact = malloc(n ? n : 1);

		memcpy(exact, tables.data, n);
		CHECK(tile_decoder_create(&codec, (struct bytes){ exact, n }) == -EBADMSG);
		CHECK(codec == NULL);
		free(exact);
	}
	CHECK(tile_decoder_create(&codec, buffer_bytes(&tile)) == -EBADMSG);
	CHECK(tile_decoder_create(&codec, buffer_bytes(&tables)) == 0);
	for (size_t n = 0; n < tile.size; n++) {
		uint8_t *exact = malloc(n ? n : 1);

		memcpy(exact, tile.data, n);
		CHECK(tile_decode(codec, back, SIDE, (struct bytes){ exact, n }) == -EBADMSG);
		free(exact);
	}
	buffer_put_u8(&tile, 0);
	CHECK(tile_decode(codec, back, SIDE, buffer_bytes(&tile)) == -EBADMSG);
	tile.size--;
	CHECK(tile_decode(codec, back, SIDE, buffer_bytes(&tile)) == 0); /* none spoiled it */
	tile_codec_destroy(codec);
	buffer_finish(&tables);
	buffer_finish(&tile);
	free(rgb);
	free(back);
}

static void survives_bit_flips(void **state)
{
	uint8_t *rgb = smooth_picture(), *back = malloc(PIXELS_BYTES),
		*sound = malloc(PIXELS_BYTES);
	struct buffer tables, tile;
	struct tile_codec *codec;

	(void)state;
	encode(&tables, &tile, rgb, false);
	CHECK(tile_decoder_create(&codec, buffer_bytes(&tables)) == 0);
	CHECK(tile_decode(codec, sound, SIDE, buffer_bytes(&tile)) == 0);
	for (size_t bit = 0; bit < tile.size * 8; bit += 7) {
		int rc;

		tile.data[bit / 8] ^= (uint8_t)(1u << bit % 8);
		rc = tile_decode(codec, back, SIDE, buffer_bytes(&tile));
		CHECK(rc == 0 || rc == -EBADMSG);
		tile.data[bit / 8] ^= (uint8_t)(1u << bit % 8);
	}
	CHECK(tile_decode(codec, back, SIDE, buffer_bytes(&tile)) == 0);
	CHECK(memcmp(back, sound, PIXELS_BYTES) == 0);
	tile_codec_destroy(codec);
	buffer_finish(&tables);
	buffer_finish(&tile);
	free(rgb);
	free(back);
	free(sound);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(gives_back_the_picture),
		cmocka_unit_test(is_the_same_bytes_every_time),
		cmocka_unit_test(refuses_every_truncation),
		cmocka_unit_test(survives_bit_flips),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
