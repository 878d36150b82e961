#include <stdlib.h>
#include <string.h>

#include "pipeline/samples/pyramid.h"
#include "tests/check.h"

enum { SIDE = 20 };

/* The lower left quarter red, a sample of it a back; nothing elsewhere. */
static uint8_t *picture(void)
{
	uint8_t *rgba = calloc(SIDE * SIDE, 4);

	for (int y = SIDE / 2; y < SIDE; y++)
		for (int x = 0; x < SIDE / 2; x++)
			memcpy(rgba + 4 * (y * SIDE + x), "\310\012\024\040", 4);
	rgba[4 * (SIDE - 1) * SIDE + 3]++;
	return rgba;
}

static void set(struct pyramid *pyramid, const uint8_t *rgba, uint64_t *covered, uint64_t *backs)
{
	memcpy(pyramid->levels[0], rgba, SIDE * SIDE * 4);
	pyramid_count(pyramid, covered, backs);
}

static void counts_samples(void **state)
{
	struct pyramid pyramid;
	uint8_t *rgba = picture();
	uint64_t covered, backs;

	(void)state;
	CHECK(pyramid_init(&pyramid, SIDE) == 0);
	set(&pyramid, rgba, &covered, &backs);
	CHECK(covered == SIDE * SIDE && backs == 1);
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
	uint64_t covered, backs;

	(void)state;
	rgba[4 * (SIDE - 1) + 3] = 8; /* a sample of the upper right corner, black */
	CHECK(pyramid_init(&pyramid, SIDE) == 0);
	set(&pyramid, rgba, &covered, &backs);
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
	uint64_t covered, backs;

	(void)state;
	CHECK(pyramid_init(&pyramid, SIDE) == 0);
	set(&pyramid, rgba, &covered, &backs);
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
	uint8_t *rgba = calloc(SIDE * SIDE, 4);
	uint64_t covered, backs;

	(void)state;
	CHECK(pyramid_init(&pyramid, SIDE) == 0);
	set(&pyramid, rgba, &covered, &backs);
	pyramid_reduce(&pyramid);
	pyramid_fill(&pyramid);
	CHECK(covered == 0 && backs == 0);
	for (int i = 0; i < SIDE * SIDE; i++)
		CHECK(memcmp(pyramid.levels[0][i], "\0\0\0", 4) == 0);
	pyramid_finish(&pyramid);
	free(rgba);
}

/* Edges are overdrawn by as much on either side; flat places stay. */
static void sharpens_edges_alone(void **state)
{
	struct pyramid pyramid;
	uint8_t *rgba = picture();
	uint64_t covered, backs;

	(void)state;
	for (int i = 0; i < SIDE * SIDE; i++)
		memcpy(rgba + (size_t)4 * i, i % SIDE < SIDE / 2 ? "ddd\040" : "\244\244\244\040",
		       4);
	CHECK(pyramid_init(&pyramid, SIDE) == 0);
	set(&pyramid, rgba, &covered, &backs);
	pyramid_reduce(&pyramid);
	pyramid_fill(&pyramid);
	for (uint32_t level = 0; level < 2; level++) {
		int side = SIDE >> level, edge = side / 2;
		uint8_t sharp[SIDE * SIDE * 3], part[4 * 4 * 3];

		pyramid_sharpen(&pyramid, level, 0, 0, (uint32_t)side, sharp);
		for (int i = 0; i < side * side; i++) {
			const uint8_t *row = sharp + (size_t)(i / side * side) * 3;
			int x = i % side, over = row[3 * edge] - 164;

			CHECK(over > 0 && over < 16 && row[3 * (edge - 1)] == 100 - over);
			if (x != edge && x != edge - 1)
				CHECK(row[3 * x + 1] == (x < edge ? 100 : 164));
		}
		/* a part has the same pixels as the whole */
		pyramid_sharpen(&pyramid, level, (uint32_t)edge - 2, 3, 4, part);
		for (int y = 0; y < 4; y++)
			CHECK(memcmp(part + (size_t)y * 12,
				     sharp + ((size_t)(y + 3) * (size_t)side + (size_t)edge - 2) *
						     3,
				     12) == 0);
	}
	pyramid_finish(&pyramid);
	free(rgba);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(counts_samples),
		cmocka_unit_test(covers_silhouettes_in_part),
		cmocka_unit_test(fills_only_the_background),
		cmocka_unit_test(sharpens_edges_alone),
		cmocka_unit_test(stays_black_where_nothing_is),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
