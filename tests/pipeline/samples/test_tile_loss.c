#include "pipeline/samples/tile_loss.h"

#include <stdlib.h>
#include <string.h>

#include "format/tile.h"
#include "tests/check.h"

enum { PIXELS = SAMPLE_IMAGE_PX * SAMPLE_IMAGE_PX };

static uint8_t picture[3 * PIXELS], other[3 * PIXELS];
static uint8_t all[TILE_WINDOWS];

static int draw(void **state)
{
	uint32_t noise = 1;

	(void)state;
	memset(all, 1, sizeof(all));
	for (uint32_t i = 0; i < PIXELS; i++) {
		noise = noise * 1664525u + 1013904223u;
		for (int k = 0; k < 3; k++)
			picture[3 * i + (uint32_t)k] = (uint8_t)(60 + i % SAMPLE_IMAGE_PX +
								 (noise >> 27) * (unsigned)(k + 1));
	}
	return 0;
}

static void the_same_loses_nothing(void **state)
{
	(void)state;
	CHECK(tile_loss(picture, picture, all) == 0);
}

static void only_what_shows_counts(void **state)
{
	uint8_t one[TILE_WINDOWS] = { 0 };

	(void)state;
	memcpy(other, picture, sizeof(other));
	/* The window in row 2, column 3. */
	for (uint32_t y = 16; y < 24; y++)
		memset(other + 3 * (y * SAMPLE_IMAGE_PX + 24), y % 2 ? 255 : 0, 3 * 8);
	CHECK(tile_loss(picture, other, one) == 0);
	one[2 * TILE_WINDOW_SIDE + 4] = 1;
	CHECK(tile_loss(picture, other, one) == 0);
	one[2 * TILE_WINDOW_SIDE + 3] = 1;
	CHECK(tile_loss(picture, other, one) > TILE_LOSS_WINDOW / 2);
	CHECK(tile_loss(picture, other, one) <= TILE_LOSS_WINDOW);
	CHECK(tile_loss(picture, other, all) == tile_loss(picture, other, one));
}

static void a_lower_quality_loses_more(void **state)
{
	static const int qualities[] = { 20, 60, 95 };
	uint32_t before = UINT32_MAX;

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(qualities); i++) {
		struct buffer object;
		uint32_t loss;

		buffer_init(&object, 1 << 20);
		CHECK(tile_encode(&object, picture, SAMPLE_IMAGE_PX, qualities[i], TILE_QUICK) ==
		      0);
		CHECK(tile_decode(other, SAMPLE_IMAGE_PX, buffer_bytes(&object)) == 0);
		loss = tile_loss(picture, other, all);
		CHECK(loss > 0 && loss < before);
		before = loss;
		buffer_finish(&object);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_same_loses_nothing),
		cmocka_unit_test(only_what_shows_counts),
		cmocka_unit_test(a_lower_quality_loses_more),
	};

	return cmocka_run_group_tests(tests, draw, NULL);
}
