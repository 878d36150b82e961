#include "base/clock.h"

#include "tests/check.h"

static void a_battery_that_agrees_is_believed(void **state)
{
	(void)state;
	CHECK(clock_agrees("1719835200\n", 1719835200));
	CHECK(clock_agrees("1719835200\n", 1719835200 + 3 * 3600));
}

static void a_dead_battery_is_not(void **state)
{
	(void)state;
	CHECK(!clock_agrees("946684800\n", 1719835200));
	CHECK(!clock_agrees("1719835200\n", 1719835200 - 2 * 24 * 3600));
	CHECK(!clock_agrees("", 0));
	CHECK(!clock_agrees("none", 0));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_battery_that_agrees_is_believed),
		cmocka_unit_test(a_dead_battery_is_not),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
