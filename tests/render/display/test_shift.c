#include "render/display/shift.h"

#include <stdlib.h>
#include <string.h>

#include "tests/check.h"

enum { SIDE = 2 * SHIFT_MOST_PX + 1, ROUND = 2 * SIDE * SIDE };

static void steps_one_pixel_at_a_time(void **state)
{
	int before[2], now[2];

	(void)state;
	shift_at(0, before);
	for (int64_t step = 1; step < 3 * ROUND; step++) {
		shift_at(step * SHIFT_STEP_MS, now);
		CHECK(abs(now[0] - before[0]) + abs(now[1] - before[1]) <= 1);
		CHECK(abs(now[0]) <= SHIFT_MOST_PX && abs(now[1]) <= SHIFT_MOST_PX);
		memcpy(before, now, sizeof(now));
	}
}

static void is_everywhere_equally_long(void **state)
{
	int visits[SIDE][SIDE] = { { 0 } }, at[2];

	(void)state;
	for (int64_t step = 0; step < ROUND; step++) {
		shift_at(step * SHIFT_STEP_MS + SHIFT_STEP_MS - 1, at);
		visits[at[1] + SHIFT_MOST_PX][at[0] + SHIFT_MOST_PX]++;
	}
	for (int y = 0; y < SIDE; y++)
		for (int x = 0; x < SIDE; x++)
			CHECK(visits[y][x] == 2);
}

static void rests_between_steps(void **state)
{
	int a[2], b[2];

	(void)state;
	shift_at(7 * SHIFT_STEP_MS, a);
	shift_at(8 * SHIFT_STEP_MS - 1, b);
	CHECK(memcmp(a, b, sizeof(a)) == 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(steps_one_pixel_at_a_time),
		cmocka_unit_test(is_everywhere_equally_long),
		cmocka_unit_test(rests_between_steps),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
