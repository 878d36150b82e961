#include "base/parallel.h"

#include <errno.h>
#include <stdatomic.h>
#include <stdbool.h>

#include "tests/check.h"

enum { ITEMS = 1003, RANGE = 10 };

struct done {
	atomic_uint times[ITEMS];
	bool fails;
};

static int do_range(void *user, uint32_t first, uint32_t after, uint32_t worker)
{
	struct done *done = user;

	if (first % RANGE != 0 || after <= first || after - first > RANGE || worker >= 3)
		return -EINVAL;
	for (uint32_t i = first; i < after; i++)
		done->times[i]++;
	return done->fails && first >= 500 ? -(int)first : 0;
}

static void ranges_cover_every_item_once(void **state)
{
	const uint32_t counts[] = { 0, 1, RANGE - 1, RANGE, RANGE + 1, ITEMS };
	(void)state;

	for (size_t c = 0; c < sizeof(counts) / sizeof(counts[0]); c++)
		for (uint32_t jobs = 1; jobs <= 3; jobs++) {
			struct done done = { .fails = false };

			CHECK(parallel_ranges(jobs, counts[c], RANGE, do_range, &done) == 0);
			for (uint32_t i = 0; i < ITEMS; i++)
				CHECK(done.times[i] == (i < counts[c]));
		}
}

static void the_lowest_failure_is_the_result(void **state)
{
	(void)state;

	for (uint32_t jobs = 1; jobs <= 3; jobs++) {
		struct done done = { .fails = true };

		CHECK(parallel_ranges(jobs, ITEMS, RANGE, do_range, &done) == -500);
		CHECK(done.times[499] == 1 && done.times[ITEMS - 1] == 0);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(ranges_cover_every_item_once),
		cmocka_unit_test(the_lowest_failure_is_the_result),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
