#include "system/hours.h"

#include <stdio.h>
#include <stdlib.h>

#include "tests/check.h"

static struct hours parsed(const char *text)
{
	struct hours hours;

	if (!hours_parse(&hours, text))
		fail_msg("refused: %s", text);
	return hours;
}

static bool open_on(const struct hours *hours, int wday, int hour, int min)
{
	return hours_open_at(hours,
			     &(struct tm){ .tm_wday = wday, .tm_hour = hour, .tm_min = min });
}

static void zone(const char *name)
{
	setenv("TZ", name, 1);
	tzset();
}

static time_t local(int month, int day, int hour, int min, int sec)
{
	struct tm tm = { .tm_year = 2026 - 1900,
			 .tm_mon = month - 1,
			 .tm_mday = day,
			 .tm_hour = hour,
			 .tm_min = min,
			 .tm_sec = sec,
			 .tm_isdst = -1 };

	return mktime(&tm);
}

static void opens_and_closes_on_the_minute(void **state)
{
	struct hours hours = parsed("Mo-Fr 09:00-18:00, Sa 10:00-17:00");

	(void)state;
	CHECK(!open_on(&hours, 1, 8, 59) && open_on(&hours, 1, 9, 0));
	CHECK(open_on(&hours, 5, 17, 59) && !open_on(&hours, 5, 18, 0));
	CHECK(!open_on(&hours, 6, 9, 59) && open_on(&hours, 6, 10, 0));
	CHECK(!open_on(&hours, 6, 17, 0) && !open_on(&hours, 0, 12, 0));
}

static void knows_lists_of_days_and_times_and_every_day(void **state)
{
	struct hours hours = parsed("mon,Wednesday - fr 9:00-12:00,14:00 - 18:00; Su 10:00-24:00");

	(void)state;
	CHECK(open_on(&hours, 1, 9, 0) && open_on(&hours, 1, 14, 0) && !open_on(&hours, 1, 12, 0));
	CHECK(!open_on(&hours, 2, 10, 0) && open_on(&hours, 3, 10, 0) && open_on(&hours, 5, 17, 0));
	CHECK(open_on(&hours, 0, 23, 59) && !open_on(&hours, 1, 0, 0));
	hours = parsed("08:30-20:00");
	for (int day = 0; day < 7; day++)
		CHECK(open_on(&hours, day, 8, 30) && !open_on(&hours, day, 20, 0));
	hours = parsed("Sa-Mo 10:00-11:00");
	CHECK(open_on(&hours, 6, 10, 0) && open_on(&hours, 0, 10, 0) && open_on(&hours, 1, 10, 0));
	CHECK(!open_on(&hours, 2, 10, 0));
}

static void goes_on_over_midnight_and_over_the_end_of_the_week(void **state)
{
	struct hours hours = parsed("Fr-Sa 18:00-02:00");

	(void)state;
	CHECK(open_on(&hours, 5, 18, 0) && open_on(&hours, 6, 1, 59) && !open_on(&hours, 6, 2, 0));
	CHECK(open_on(&hours, 6, 23, 59) && open_on(&hours, 0, 0, 0) && open_on(&hours, 0, 1, 59));
	CHECK(!open_on(&hours, 0, 2, 0) && !open_on(&hours, 5, 1, 0));
}

static void refuses_what_is_no_hours(void **state)
{
	static const char *const bad[] = {
		"",
		" ",
		"Mo",
		"Mo-",
		"Mo-Fr",
		"Mo-Fr 9-18",
		"Mo-Fr 09:00",
		"Mo-Fr 09:00-",
		"Mo-Fr 09:00-25:00",
		"Mo-Fr 09:60-18:00",
		"Mo-Fr 09:00-24:01",
		"Mo-Fr 24:00-09:00",
		"Mo-Fr 009:00-18:00",
		"Mo-Fr 09:00-09:00",
		"Mo-Fr 09:00-18:00,",
		"Mo-Fr 09:00-18:00, Sa",
		"Mo-Fr 09:00-18:00 Sa 10:00-17:00",
		"Montag 09:00-18:00",
		"M 09:00-18:00",
		"Mo-Xx 09:00-18:00",
		", Mo 09:00-18:00",
		"always",
	};

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
		struct hours hours;

		if (hours_parse(&hours, bad[i]))
			fail_msg("taken: '%s'", bad[i]);
	}
}

static void says_minutes_until_it_changes(void **state)
{
	struct hours hours = parsed("Mo-Fr 09:00-18:00, Sa 10:00-17:00");

	(void)state;
	zone("Asia/Phnom_Penh");
	CHECK(hours_change_min(&hours, local(11, 23, 8, 0, 0)) == 60);           /* Monday, opens */
	CHECK(hours_change_min(&hours, local(11, 23, 9, 0, 0)) == 9 * 60);       /* closes */
	CHECK(hours_change_min(&hours, local(11, 23, 17, 59, 30)) == 1);         /* rounded up */
	CHECK(hours_change_min(&hours, local(11, 28, 17, 0, 0)) == 40 * 60);     /* Sa to Mo */
	CHECK(hours_change_min(&hours, local(12, 31, 23, 59, 0)) == 9 * 60 + 1); /* new year */
	hours_always(&hours);
	CHECK(hours_change_min(&hours, local(11, 23, 8, 0, 0)) == -1);
	CHECK(open_on(&hours, 0, 0, 0) && open_on(&hours, 6, 23, 59));
	hours = parsed("00:00-24:00");
	CHECK(hours_change_min(&hours, local(11, 23, 8, 0, 0)) == -1);
}

/* Berlin, 2026: on 29 March 02:00 becomes 03:00, on 25 October 03:00 becomes 02:00. */
static void counts_days_on_which_the_clocks_change_as_they_are(void **state)
{
	struct hours day = parsed("09:00-18:00");
	struct hours night = parsed("Sa 20:00-04:00");
	struct hours gap = parsed("Su 02:30-02:45");
	struct hours into_gap = parsed("Su 02:30-05:00");

	(void)state;
	zone("Europe/Berlin");
	CHECK(hours_change_min(&day, local(3, 28, 18, 0, 0)) == 14 * 60);
	CHECK(hours_change_min(&day, local(10, 24, 18, 0, 0)) == 16 * 60);
	CHECK(hours_change_min(&night, local(3, 28, 20, 0, 0)) == 7 * 60);
	CHECK(hours_change_min(&night, local(10, 24, 20, 0, 0)) == 9 * 60);
	/* Times that are not there that day: open as soon as the clock is past their beginning. */
	CHECK(hours_change_min(&into_gap, local(3, 29, 1, 0, 0)) == 60);
	CHECK(hours_change_min(&gap, local(3, 29, 1, 0, 0)) == 60 * (6 * 24 + 24) + 30);
	/* Times that are there twice: open twice. */
	CHECK(hours_change_min(&gap, local(10, 25, 1, 0, 0)) == 90);
	CHECK(hours_change_min(&gap, local(10, 25, 1, 0, 0) + 60 * 105) == 45);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(opens_and_closes_on_the_minute),
		cmocka_unit_test(knows_lists_of_days_and_times_and_every_day),
		cmocka_unit_test(goes_on_over_midnight_and_over_the_end_of_the_week),
		cmocka_unit_test(refuses_what_is_no_hours),
		cmocka_unit_test(says_minutes_until_it_changes),
		cmocka_unit_test(counts_days_on_which_the_clocks_change_as_they_are),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
