#include "app/release/trial.h"
#include "tests/check.h"

static int64_t now_ms;
static struct trial trial;
static struct trial_sight sight;
static int passed, failed; /* verdicts */

/* A release on trial has just come onto the panel; its root page is there, nothing is drawn. */
static int set_up(void **state)
{
	(void)state;
	now_ms = 1000000;
	passed = failed = 0;
	sight = (struct trial_sight){ .on_trial = true, .has_before = true, .is_complete = true };
	trial_begin(&trial, now_ms);
	return 0;
}

static void draw(bool model)
{
	sight.frame_ms = now_ms;
	sight.is_pictured = model;
}

static void after(int64_t ms)
{
	enum trial_verdict verdict;

	now_ms += ms;
	verdict = trial_judge(&trial, &sight, now_ms);
	passed += verdict == TRIAL_PASSED;
	failed += verdict == TRIAL_FAILED_BROKEN || verdict == TRIAL_FAILED_BLANK;
	if (verdict != TRIAL_GOES_ON)
		sight.on_trial = false;
}

static int wait(void)
{
	return trial_wait_ms(&trial, &sight, now_ms);
}

static void proves_what_was_seen_for_a_while(void **state)
{
	(void)state;
	CHECK(wait() > 0);
	draw(true);
	after(0);
	CHECK(passed == 0 && wait() == 10000);
	after(9999);
	CHECK(passed == 0);
	after(1);
	CHECK(passed == 1 && failed == 0 && wait() == -1);
}

static void proves_nothing_by_the_frame_before_it(void **state)
{
	(void)state;
	sight.frame_ms = trial.shown_ms - 1; /* of the release before */
	sight.is_pictured = true;            /* small and unseen */
	after(20000);
	CHECK(passed == 0);
	sight.is_dark = true;
	draw(true);
	after(20000);
	CHECK(passed == 0); /* on a panel that sleeps */
	sight.is_dark = false;
	draw(true);
	after(0);
	after(10000);
	CHECK(passed == 1);
}

static void returns_from_what_cannot_be_decoded(void **state)
{
	(void)state;
	sight.is_broken = true;
	after(0);
	CHECK(failed == 1);
	set_up(NULL);
	sight.is_broken = true;
	draw(true); /* one tile of many: it shows */
	after(0);
	CHECK(failed == 0);
}

static void returns_from_what_shows_nothing(void **state)
{
	(void)state;
	after(59999);
	CHECK(failed == 0 && wait() == 1);
	after(1);
	CHECK(failed == 1);
}

/* A kiosk that starts at night loads a little of the release and draws nothing of it. */
static void blames_no_release_for_the_night(void **state)
{
	(void)state;
	sight.is_dark = true;
	after(3600000);
	CHECK(failed == 0 && wait() == -1);
	sight.is_dark = false;
	after(0);
	CHECK(failed == 0 && wait() == 60000);
	after(60000);
	CHECK(failed == 1);
}

static void blames_no_release_for_the_network(void **state)
{
	(void)state;
	sight.is_complete = false;
	after(3600000);
	CHECK(failed == 0 && wait() == -1);
}

static void has_nowhere_to_return_at_first(void **state)
{
	(void)state;
	sight.has_before = false;
	sight.is_broken = true;
	after(3600000);
	CHECK(failed == 0 && wait() == -1);
	draw(true);
	after(0);
	after(10000);
	CHECK(passed == 1);
}

static void decides_nothing_while_the_next_one_loads(void **state)
{
	(void)state;
	sight.is_replaced = sight.is_broken = true;
	after(3600000);
	CHECK(failed == 0 && wait() == -1);
}

static void leaves_a_proven_release_alone(void **state)
{
	(void)state;
	sight.on_trial = false;
	sight.is_broken = true;
	after(3600000);
	CHECK(failed == 0 && passed == 0 && wait() == -1);
}

#define ON_TRIAL(test) cmocka_unit_test_setup(test, set_up)

int main(void)
{
	const struct CMUnitTest tests[] = {
		ON_TRIAL(proves_what_was_seen_for_a_while),
		ON_TRIAL(proves_nothing_by_the_frame_before_it),
		ON_TRIAL(returns_from_what_cannot_be_decoded),
		ON_TRIAL(returns_from_what_shows_nothing),
		ON_TRIAL(blames_no_release_for_the_night),
		ON_TRIAL(blames_no_release_for_the_network),
		ON_TRIAL(has_nowhere_to_return_at_first),
		ON_TRIAL(decides_nothing_while_the_next_one_loads),
		ON_TRIAL(leaves_a_proven_release_alone),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
