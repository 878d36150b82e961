#include "input/calibration.h"

#include <string.h>

#include "tests/check.h"

static void reads_two_rows(void **state)
{
	float m[6];

	(void)state;
	CHECK(calibration_parse("0 -1 1 1 0 0", m));
	CHECK(m[0] == 0 && m[1] == -1 && m[2] == 1 && m[3] == 1 && m[4] == 0 && m[5] == 0);
	CHECK(calibration_parse(" 1.02 0 -.01  0 0.98 1e-2 ", m) && m[5] > 0.009f);
}

static void refuses_what_is_no_matrix(void **state)
{
	static const char *const bad[] = { "",
					   "1 0 0 0 1",
					   "1 0 0 0 1 0 0",
					   "a b c d e f",
					   "1 0 0 0 1 nan",
					   "1 0 0 0 1 inf",
					   "0 0 0 0 0 0",
					   "1 2 0 2 4 0 (flat)",
					   "1 2 0 2 4 0" };
	float m[6] = { 7 };

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(bad); i++)
		if (calibration_parse(bad[i], m) || m[0] != 7)
			fail_msg("'%s'", bad[i]);
}

static void knows_nothing_of_a_device_that_is_none(void **state)
{
	float m[6] = { 7 };

	(void)state;
	CHECK(calibration_read("/dev/input/event-of-nobody", m) == 0 && m[0] == 7);
	CHECK(calibration_read("", m) == 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(reads_two_rows),
		cmocka_unit_test(refuses_what_is_no_matrix),
		cmocka_unit_test(knows_nothing_of_a_device_that_is_none),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
