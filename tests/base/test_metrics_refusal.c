/* What is kept of refusals. */
#include "base/metrics_refusal.h"

#include <string.h>

#include "base/clock.h"
#include "tests/check.h"

static void counts_all_and_keeps_the_last(void **state)
{
	const int64_t before_s = clock_wall_s();
	struct metrics_refusal refusal = { 0 };

	(void)state;
	metrics_refusal_note(&refusal, "release.json", "too few signatures");
	metrics_refusal_note(&refusal, "timestamp.json", "it is older");
	CHECK(refusal.count == 2 && refusal.at_s >= before_s);
	CHECK(strcmp(refusal.what, "timestamp.json") == 0);
	CHECK(strcmp(refusal.why, "it is older") == 0);
}

static void cuts_what_does_not_fit(void **state)
{
	struct metrics_refusal refusal = { 0 };
	char text[300];

	(void)state;
	memset(text, 'x', sizeof(text) - 1);
	text[sizeof(text) - 1] = '\0';
	metrics_refusal_note(&refusal, text, text);
	CHECK(strlen(refusal.what) == METRICS_REFUSAL_WHAT_BYTES - 1);
	CHECK(strlen(refusal.why) == METRICS_REFUSAL_WHY_BYTES - 1);
	metrics_refusal_note(NULL, text, text);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(counts_all_and_keeps_the_last),
		cmocka_unit_test(cuts_what_does_not_fit),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
