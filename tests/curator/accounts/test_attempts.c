#include "curator/accounts/attempts.h"

#include <stdio.h>
#include <string.h>

#include "tests/check.h"

static struct attempts attempts;

static int start(void **state)
{
	(void)state;
	memset(&attempts, 0, sizeof(attempts));
	return 0;
}

static void a_name_that_fails_waits_longer_each_time(void **state)
{
	int64_t now_ms = 5, last_ms = 500, wait_ms;
	char address[32];

	(void)state;
	for (int n = 0; n < ATTEMPTS_FREE_OF_NAME; n++)
		CHECK(attempts_begin(&attempts, "ana", "192.0.2.1", now_ms) == 0);
	CHECK(attempts_begin(&attempts, "ana", "192.0.2.1", now_ms) == 0); /* now it must wait */
	for (int n = 0; n < 6; n++) {
		snprintf(address, sizeof(address), "192.0.2.%d", 10 + n); /* wherever it is from */
		wait_ms = attempts_begin(&attempts, "ana", address, now_ms);
		CHECK(wait_ms == 2 * last_ms);
		CHECK(attempts_begin(&attempts, "ana", address, now_ms + wait_ms - 1) == 1);
		now_ms += wait_ms;
		CHECK(attempts_begin(&attempts, "ana", address, now_ms) == 0);
		last_ms = wait_ms;
	}
	for (int n = 0; n < 40; n++) {
		wait_ms = attempts_begin(&attempts, "ana", "198.51.100.1", now_ms);
		CHECK(wait_ms <= ATTEMPTS_WAIT_OF_ADDRESS_MS);
		now_ms += wait_ms;
	}
}

static void another_name_and_address_need_not_wait(void **state)
{
	(void)state;
	for (int n = 0; n < 10; n++)
		CHECK(attempts_begin(&attempts, "ana", "192.0.2.1", 0) >= 0);
	CHECK(attempts_begin(&attempts, "ana", "192.0.2.1", 0) > 0);
	CHECK(attempts_begin(&attempts, "rolf", "192.0.2.2", 0) == 0);
	CHECK(attempts_begin(&attempts, "192.0.2.1", "ana", 0) == 0);
}

static void an_address_that_tries_many_names_waits(void **state)
{
	char name[16];
	int64_t wait_ms = 0;
	int tried = 0;

	(void)state;
	for (; wait_ms == 0 && tried < 1000; tried++) {
		snprintf(name, sizeof(name), "name%d", tried);
		wait_ms = attempts_begin(&attempts, name, "192.0.2.1", 0);
	}
	CHECK(tried == ATTEMPTS_FREE_OF_ADDRESS + 2);
}

static void success_forgives_the_name(void **state)
{
	(void)state;
	for (int n = 0; n < 100; n++) {
		CHECK(attempts_begin(&attempts, "ana", "192.0.2.1", 0) == 0);
		attempts_succeed(&attempts, "ana", "192.0.2.1");
	}
}

static void success_with_one_name_does_not_forgive_guesses_at_another(void **state)
{
	int64_t wait_ms = 0;
	char name[16];

	(void)state;
	for (int n = 0; n < 100 && wait_ms == 0; n++) {
		snprintf(name, sizeof(name), "name%d", n);
		wait_ms = attempts_begin(&attempts, name, "192.0.2.1", 0);
		if (wait_ms == 0 && attempts_begin(&attempts, "own", "192.0.2.1", 0) == 0)
			attempts_succeed(&attempts, "own", "192.0.2.1");
	}
	CHECK(wait_ms > 0);
}

static void failures_are_forgotten_after_an_hour(void **state)
{
	(void)state;
	for (int n = 0; n < 20; n++)
		CHECK(attempts_begin(&attempts, "ana", "192.0.2.1", 0) >= 0);
	for (int n = 0; n < ATTEMPTS_FREE_OF_NAME; n++)
		CHECK(attempts_begin(&attempts, "ana", "192.0.2.1", ATTEMPTS_FORGOTTEN_MS) == 0);
}

static void more_names_than_it_remembers_do_no_harm(void **state)
{
	char name[16], address[16];

	(void)state;
	for (int n = 0; n < 3 * ATTEMPTS_MAX; n++) {
		snprintf(name, sizeof(name), "n%d", n);
		snprintf(address, sizeof(address), "a%d", n);
		CHECK(attempts_begin(&attempts, name, address, n) == 0);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup(a_name_that_fails_waits_longer_each_time, start),
		cmocka_unit_test_setup(another_name_and_address_need_not_wait, start),
		cmocka_unit_test_setup(an_address_that_tries_many_names_waits, start),
		cmocka_unit_test_setup(success_forgives_the_name, start),
		cmocka_unit_test_setup(success_with_one_name_does_not_forgive_guesses_at_another,
				       start),
		cmocka_unit_test_setup(failures_are_forgotten_after_an_hour, start),
		cmocka_unit_test_setup(more_names_than_it_remembers_do_no_harm, start),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
