#include <stdlib.h>
#include <string.h>

#include "pipeline/pyramid.h"
#include "tests/check.h"

enum { SIDE = 20 };

/* Twice SIDE wide; the lower left quarter red, one pixel of it marked; nothing elsewhere. */
static uint8_t *picture(void)
{
	uint8_t *rgba = calloc(4 * SIDE * SIDE, 4);

	for (int y = 0; y < SIDE; y++)
		for (int x = 0; x < SIDE; x++)
			memcpy(rgba + 4 * (y * 2 * SIDE + x), "\310\012\024\377", 4);
	rgba[3] = 254;
	return rgba;
}

static void counts_and_flips(void **state)
{
	struct pyramid pyramid;
	uint8_t *rgba = picture();
	uint64_t covered, marked;

	(void)state;
	CHECK(pyramid_init(&pyramid, SIDE) == 0);
	pyramid_set(&pyramid, rgba, 254, &covered, &marked);
	CHECK(covered == SIDE * SIDE && marked == 1);
	for (int y = 0; y < SIDE; y++) {
		for (int x = 0; x < SIDE; x++) {
			const uint8_t *p = pyramid.levels[0][y * SIDE + x];
			bool there = x < SIDE / 2 && y >= SIDE / 2;

			CHECK(p[3] == (there ? 255 : 0) && p[0] == (there ? 200 : 0));
		}
	}
	pyramid_finish(&pyramid);
	free(rgba);
}

static void covers_silhouettes_in_part(void **state)
{
	struct pyramid pyramid;
	uint8_t *rgba = picture();
	uint64_t covered, marked;

	(void)state;
	rgba[4 * SIDE * SIDE * 4 - 1] = 255; /* the last pixel: upper right corner, black */
	CHECK(pyramid_init(&pyramid, SIDE) == 0);
	pyramid_set(&pyramid, rgba, 254, &covered, &marked);
	pyramid_reduce(&pyramid);
	CHECK(pyramid.levels[0][SIDE - 1][3] == 63 && pyramid.levels[0][SIDE - 1][0] == 0);
	/* Whatever shows anything still shows it in the coarsest, in its own colour. */
	CHECK(pyramid.levels[1][SIDE / 2 - 1][3] == 16);
	for (uint32_t level = 0; level < pyramid.level_count; level++)
		CHECK(pyramid.levels[level][pyramid.side_px[level] - 1][3] > 0);
	CHECK(pyramid.side_px[pyramid.level_count - 1] == 1);
	pyramid_finish(&pyramid);
	free(rgba);
}

static void fills_only_the_background(void **state)
{
	struct pyramid pyramid;
	uint8_t *rgba = picture();
	uint64_t covered, marked;

	(void)state;
	CHECK(pyramid_init(&pyramid, SIDE) == 0);
	pyramid_set(&pyramid, rgba, 254, &covered, &marked);
	pyramid_reduce(&pyramid);
	pyramid_fill(&pyramid);
	for (int i = 0; i < SIDE * SIDE; i++) {
		const uint8_t *p = pyramid.levels[0][i];
		bool there = i % SIDE < SIDE / 2 && i / SIDE >= SIDE / 2;

		CHECK(p[3] == (there ? 255 : 0));
		CHECK(abs(p[0] - 200) <= 1 && abs(p[1] - 10) <= 1 && abs(p[2] - 20) <= 1);
	}
	pyramid_finish(&pyramid);
	free(rgba);
}

static void stays_black_where_nothing_is(void **state)
{
	struct pyramid pyramid;
	uint8_t *rgba = calloc(4 * SIDE * SIDE, 4);
	uint64_t covered, marked;

	(void)state;
	CHECK(pyramid_init(&pyramid, SIDE) == 0);
	pyramid_set(&pyramid, rgba, 254, &covered, &marked);
	pyramid_reduce(&pyramid);
	pyramid_fill(&pyramid);
	CHECK(covered == 0 && marked == 0);
	for (int i = 0; i < SIDE * SIDE; i++)
		CHECK(memcmp(pyramid.levels[0][i], "\0\0\0", 4) == 0);
	pyramid_finish(&pyramid);
	free(rgba);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(counts_and_flips),
		cmocka_unit_test(covers_silhouettes_in_part),
		cmocka_unit_test(fills_only_the_background),
		cmocka_unit_test(stays_black_where_nothing_is),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
