#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <webp/decode.h>
#include <webp/encode.h>

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

/* Edges of several sizes, and grain as stone has it. */
static uint8_t *rough_picture(void)
{
	uint8_t *rgb = malloc(PIXELS_BYTES);
	uint32_t random = 1;

	for (int i = 0; i < PIXELS_BYTES; i++) {
		int x = i / 3 % SIDE, y = i / 3 / SIDE, c = i % 3;

		random = random * 1664525 + 1013904223;
		rgb[i] = (uint8_t)(128 + 40 * sin(x * 0.07 + c) + 20 * sin(x * 0.11 + y * 0.37) +
				   12 * sin(x * 0.9 - y * 0.53) + (random >> 29));
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

static void encode(struct buffer *tile, const uint8_t *rgb)
{
	buffer_init(tile, 1000000);
	CHECK(tile_encode(tile, rgb, SIDE, 80, TILE_THOROUGH) == 0);
}

static void gives_back_the_picture(void **state)
{
	uint8_t *rgb = smooth_picture(), *back = malloc(PIXELS_BYTES);
	struct buffer tile;

	(void)state;
	encode(&tile, rgb);
	CHECK(tile_decode(back, SIDE, buffer_bytes(&tile)) == 0);
	CHECK(psnr(rgb, back) > 38);
	CHECK(tile_decode(back, SIDE / 2, buffer_bytes(&tile)) == -EBADMSG);
	CHECK(tile_decode(back, 0, buffer_bytes(&tile)) == -EINVAL);
	buffer_finish(&tile);
	free(rgb);
	free(back);
}

static void takes_more_bytes_for_less_effort(void **state)
{
	uint8_t *rgb = rough_picture(), *back = malloc(PIXELS_BYTES);
	struct buffer thorough, quick;
	double best;

	(void)state;
	encode(&thorough, rgb);
	buffer_init(&quick, 1000000);
	CHECK(tile_encode(&quick, rgb, SIDE, 80, TILE_QUICK) == 0);
	CHECK(quick.size > thorough.size && quick.size < thorough.size + thorough.size / 10);
	CHECK(tile_decode(back, SIDE, buffer_bytes(&thorough)) == 0);
	best = psnr(rgb, back);
	CHECK(tile_decode(back, SIDE, buffer_bytes(&quick)) == 0);
	CHECK(fabs(psnr(rgb, back) - best) < 0.2);
	buffer_finish(&thorough);
	buffer_finish(&quick);
	free(rgb);
	free(back);
}

/* What other decoders of WebP need before the frame is its container alone. */
static void is_a_webp_picture_without_its_container(void **state)
{
	uint8_t *rgb = smooth_picture(), *back = malloc(PIXELS_BYTES), *again;
	struct buffer tile, file;
	int width, height;

	(void)state;
	encode(&tile, rgb);
	CHECK(tile_decode(back, SIDE, buffer_bytes(&tile)) == 0);
	buffer_init(&file, 1000000);
	buffer_put(&file, "RIFF", 4);
	buffer_put_u32(&file, (uint32_t)(12 + tile.size + tile.size % 2));
	buffer_put(&file, "WEBPVP8 ", 8);
	buffer_put_u32(&file, (uint32_t)tile.size);
	buffer_put(&file, tile.data, tile.size);
	buffer_put(&file, "", tile.size % 2);
	again = WebPDecodeRGB(file.data, file.size, &width, &height);
	CHECK(again && width == SIDE && height == SIDE);
	CHECK(memcmp(again, back, PIXELS_BYTES) == 0);
	CHECK(tile_decode(back, SIDE, buffer_bytes(&file)) == -EBADMSG);
	WebPFree(again);
	buffer_finish(&tile);
	buffer_finish(&file);
	free(rgb);
	free(back);
}

static void refuses_other_kinds_of_webp(void **state)
{
	uint8_t *rgb = smooth_picture(), *back = malloc(PIXELS_BYTES), *lossless;
	size_t size = WebPEncodeLosslessRGB(rgb, SIDE, SIDE, SIDE * 3, &lossless);

	(void)state;
	CHECK(size > 20);
	CHECK(tile_decode(back, SIDE, (struct bytes){ lossless, size }) == -EBADMSG);
	CHECK(tile_decode(back, SIDE, (struct bytes){ lossless + 20, size - 20 }) == -EBADMSG);
	WebPFree(lossless);
	free(rgb);
	free(back);
}

static void is_the_same_bytes_every_time(void **state)
{
	uint8_t *rgb = smooth_picture();
	struct buffer tile, again;

	(void)state;
	encode(&tile, rgb);
	encode(&again, rgb);
	CHECK(again.size == tile.size && memcmp(again.data, tile.data, tile.size) == 0);
	buffer_finish(&tile);
	buffer_finish(&again);
	free(rgb);
}

/* The coder may read up to two bytes less than it wrote. */
static void refuses_every_truncation(void **state)
{
	uint8_t *rgb = smooth_picture(), *back = malloc(PIXELS_BYTES),
		*whole = malloc(PIXELS_BYTES);
	struct buffer tile;

	(void)state;
	encode(&tile, rgb);
	CHECK(tile_decode(whole, SIDE, buffer_bytes(&tile)) == 0);
	for (size_t n = 0; n < tile.size; n++) {
		uint8_t *exact = malloc(n ? n : 1);
		int rc;

		memcpy(exact, tile.data, n);
		rc = tile_decode(back, SIDE, (struct bytes){ exact, n });
		CHECK(rc == -EBADMSG ||
		      (n + 2 >= tile.size && rc == 0 && memcmp(back, whole, PIXELS_BYTES) == 0));
		free(exact);
	}
	buffer_finish(&tile);
	free(rgb);
	free(back);
	free(whole);
}

static void survives_bit_flips(void **state)
{
	uint8_t *rgb = smooth_picture(), *back = malloc(PIXELS_BYTES);
	struct buffer tile;

	(void)state;
	encode(&tile, rgb);
	for (size_t bit = 0; bit < tile.size * 8; bit += 7) {
		int rc;

		tile.data[bit / 8] ^= (uint8_t)(1u << bit % 8);
		rc = tile_decode(back, SIDE, buffer_bytes(&tile));
		CHECK(rc == 0 || rc == -EBADMSG);
		tile.data[bit / 8] ^= (uint8_t)(1u << bit % 8);
	}
	buffer_finish(&tile);
	free(rgb);
	free(back);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(gives_back_the_picture),
		cmocka_unit_test(takes_more_bytes_for_less_effort),
		cmocka_unit_test(is_a_webp_picture_without_its_container),
		cmocka_unit_test(refuses_other_kinds_of_webp),
		cmocka_unit_test(is_the_same_bytes_every_time),
		cmocka_unit_test(refuses_every_truncation),
		cmocka_unit_test(survives_bit_flips),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
