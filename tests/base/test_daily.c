#include "base/daily.h"

#include <errno.h>
#include <stdlib.h>
#include <time.h>

#include "tests/check.h"

/* On the first of January 1970, in UTC. */
static bool holds(const char *text, int hour, int minute)
{
	struct daily daily;

	CHECK(daily_parse(&daily, text) == 0);
	return daily_holds(&daily, hour * 3600 + minute * 60);
}

static void holds_between_its_ends(void **state)
{
	(void)state;
	CHECK(!holds("08:30-17:00", 8, 29) && holds("08:30-17:00", 8, 30));
	CHECK(holds("08:30-17:00", 16, 59) && !holds("08:30-17:00", 17, 0));
	CHECK(holds("20:00-24:00", 23, 59) && !holds("20:00-24:00", 0, 0));
}

static void goes_past_midnight(void **state)
{
	(void)state;
	CHECK(holds("22:00-06:00", 22, 0) && holds("22:00-06:00", 5, 59));
	CHECK(!holds("22:00-06:00", 6, 0) && !holds("22:00-06:00", 21, 59));
}

static void holds_always_unless_told(void **state)
{
	const struct daily none = { 0 };

	(void)state;
	CHECK(daily_holds(&none, 12345) && holds("07:00-07:00", 3, 0));
	CHECK(holds("00:00-24:00", 0, 0) && holds("00:00-24:00", 23, 59));
}

static void is_of_local_time(void **state)
{
	(void)state;
	setenv("TZ", "UTC-7", 1); /* Phnom Penh */
	tzset();
	CHECK(holds("22:00-06:00", 15, 0) && !holds("22:00-06:00", 23, 0));
	setenv("TZ", "UTC", 1);
	tzset();
}

static void refuses_what_is_no_time(void **state)
{
	static const char *const bad[] = { "",
					   "22:00",
					   "22-06",
					   "22:00-06:60",
					   "25:00-26:00",
					   "24:01-06:00",
					   "22:00-06:00 ",
					   "2:00-06:00",
					   "22:00-6:000",
					   "-2:00-06:00",
					   "ab:cd-ef:gh" };
	struct daily daily;

	(void)state;
	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++)
		CHECK(daily_parse(&daily, bad[i]) == -EINVAL);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(holds_between_its_ends),   cmocka_unit_test(goes_past_midnight),
		cmocka_unit_test(holds_always_unless_told), cmocka_unit_test(is_of_local_time),
		cmocka_unit_test(refuses_what_is_no_time),
	};

	setenv("TZ", "UTC", 1);
	tzset();
	return cmocka_run_group_tests(tests, NULL, NULL);
}
