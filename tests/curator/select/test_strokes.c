#include "curator/select/strokes.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "base/compiler.h"
#include "tests/check.h"

enum { WIDTH = 64, HEIGHT = 48, PIXELS = WIDTH * HEIGHT };

static const float square_px[][2] = { { 10, 10 }, { 30, 10 }, { 30, 30 }, { 10, 30 } };
static const struct stroke square = { square_px, ARRAY_COUNT(square_px), 6 };

static uint32_t count_of(const uint8_t *marks, enum mark mark)
{
	uint32_t count = 0;

	for (uint32_t at = 0; at < PIXELS; at++)
		count += marks[at] == mark;
	return count;
}

static enum mark mark_at(const uint8_t *marks, uint32_t x, uint32_t y)
{
	return (enum mark)marks[y * WIDTH + x];
}

static void a_pen_is_round_and_ends_at_the_picture(void **state)
{
	static const float line[][2] = { { -50, 20 }, { 20, 20 } }, dot[][2] = { { 40, 40 } };
	const struct stroke pen = { line, 2, 8 }, touch = { dot, 1, 0 };
	uint8_t marks[PIXELS] = { 0 };

	(void)state;
	strokes_paint(marks, WIDTH, HEIGHT, &pen, MARK_PART_SEED);
	CHECK(mark_at(marks, 0, 17) == MARK_PART_SEED && mark_at(marks, 0, 23) == MARK_PART_SEED);
	CHECK(mark_at(marks, 0, 15) == MARK_UNKNOWN && mark_at(marks, 0, 24) == MARK_UNKNOWN);
	CHECK(mark_at(marks, 23, 20) == MARK_PART_SEED && mark_at(marks, 23, 17) == MARK_UNKNOWN);
	const uint32_t before = count_of(marks, MARK_PART_SEED);
	strokes_paint(marks, WIDTH, HEIGHT, &touch, MARK_PART_SEED);
	CHECK(count_of(marks, MARK_PART_SEED) > before); /* a touch leaves a pixel at least */
}

static void a_lasso_takes_what_it_goes_around(void **state)
{
	/* once around and once more inside: still one area */
	static const float twice[][2] = { { 10, 10 }, { 30, 10 }, { 30, 30 }, { 10, 30 },
					  { 10, 10 }, { 15, 15 }, { 25, 15 }, { 25, 25 },
					  { 15, 25 }, { 15, 15 } };
	static const float beyond[][2] = { { -40, -40 }, { 500, -40 }, { 500, 500 }, { -40, 500 } };
	const struct stroke loops = { twice, ARRAY_COUNT(twice), 1 },
			    around_all = { beyond, ARRAY_COUNT(beyond), 1 };
	uint8_t marks[PIXELS];

	(void)state;
	CHECK(strokes_lasso(marks, WIDTH, HEIGHT, &square) == 0);
	CHECK(count_of(marks, MARK_PART) == 400 && count_of(marks, MARK_REST) == PIXELS - 400);
	CHECK(mark_at(marks, 10, 10) == MARK_PART && mark_at(marks, 30, 10) == MARK_REST);
	CHECK(strokes_lasso(marks, WIDTH, HEIGHT, &loops) == 0);
	CHECK(count_of(marks, MARK_PART) == 400);
	CHECK(strokes_lasso(marks, WIDTH, HEIGHT, &around_all) == 0);
	CHECK(count_of(marks, MARK_PART) == PIXELS);
}

static void a_lasso_around_nothing_is_refused(void **state)
{
	static const float line[][2] = { { 5, 5.5f }, { 40, 5.5f } },
			   outside[][2] = { { 100, 100 }, { 120, 100 }, { 120, 120 } };
	const struct stroke flat = { line, 2, 4 }, away = { outside, 3, 4 };
	uint8_t marks[PIXELS];

	(void)state;
	CHECK(strokes_lasso(marks, WIDTH, HEIGHT, &flat) == -EINVAL);
	CHECK(strokes_lasso(marks, WIDTH, HEIGHT, &away) == -EINVAL);
	CHECK(strokes_heavy_lasso(marks, WIDTH, HEIGHT, &flat) == -EINVAL);
}

static void a_heavy_lasso_knows_both_sides_and_not_what_is_under_it(void **state)
{
	uint8_t marks[PIXELS];

	(void)state;
	CHECK(strokes_heavy_lasso(marks, WIDTH, HEIGHT, &square) == 0);
	CHECK(mark_at(marks, 10, 20) == MARK_UNKNOWN && mark_at(marks, 12, 20) == MARK_UNKNOWN &&
	      mark_at(marks, 8, 20) == MARK_UNKNOWN);
	CHECK(mark_at(marks, 14, 20) == MARK_PART_SEED && mark_at(marks, 5, 20) == MARK_REST_SEED);
	CHECK(mark_at(marks, 20, 20) == MARK_PART && mark_at(marks, 60, 40) == MARK_REST);
	CHECK(mark_at(marks, 20, 10) == MARK_UNKNOWN); /* also the side that closes it */
}

/* A stroke as wide as what it goes around would leave nothing that is known to be the part. */
static void a_heavy_lasso_becomes_thinner_where_it_must(void **state)
{
	const struct stroke wide = { square_px, ARRAY_COUNT(square_px), 40 };
	uint8_t marks[PIXELS];

	(void)state;
	CHECK(strokes_heavy_lasso(marks, WIDTH, HEIGHT, &wide) == 0);
	CHECK(count_of(marks, MARK_PART) + count_of(marks, MARK_PART_SEED) > 400 / 8);
	CHECK(count_of(marks, MARK_UNKNOWN) > 400 / 8);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_pen_is_round_and_ends_at_the_picture),
		cmocka_unit_test(a_lasso_takes_what_it_goes_around),
		cmocka_unit_test(a_lasso_around_nothing_is_refused),
		cmocka_unit_test(a_heavy_lasso_knows_both_sides_and_not_what_is_under_it),
		cmocka_unit_test(a_heavy_lasso_becomes_thinner_where_it_must),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
