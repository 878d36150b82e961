#include "net/line_rate.h"

#include "base/clock.h"
#include "tests/check.h"

static int64_t now_ms;

int64_t clock_now_ms(void)
{
	return now_ms;
}

static uint64_t received;

/* Time passes on a line that carries so much. */
static void carry(struct line_rate *rate, uint64_t bytes_per_s, int ms)
{
	for (int i = 0; i < ms; i += 10) {
		now_ms += 10;
		received += bytes_per_s / 100;
		line_rate_note(rate, received, true);
	}
}

static bool is_about(const struct line_rate *rate, uint64_t bytes_per_s)
{
	return rate->bytes_per_s > bytes_per_s * 9 / 10 &&
	       rate->bytes_per_s < bytes_per_s * 11 / 10;
}

static void takes_the_first_sample_as_it_is(void **state)
{
	struct line_rate rate;

	(void)state;
	line_rate_init(&rate, 1 << 20);
	CHECK(line_rate_carries(&rate, 500) == 1 << 19);
	line_rate_note(&rate, received, true);
	now_ms += 5000; /* the server takes its time: not the line's */
	carry(&rate, 8000, 600);
	CHECK(is_about(&rate, 8000));
	CHECK(line_rate_carries(&rate, 1000) == rate.bytes_per_s);
}

static void follows_a_line_that_changes(void **state)
{
	struct line_rate rate;

	(void)state;
	line_rate_init(&rate, 1 << 20);
	carry(&rate, 100000, 2000);
	CHECK(is_about(&rate, 100000));
	carry(&rate, 200000, 1000); /* within what is believed at once: little by little */
	CHECK(rate.bytes_per_s > 115000 && rate.bytes_per_s < 170000);
	carry(&rate, 200000, 12000);
	CHECK(is_about(&rate, 200000));
	carry(&rate, 8000, 2000); /* far off, but again and again */
	CHECK(is_about(&rate, 8000));
}

static void sets_noise_aside(void **state)
{
	struct line_rate rate;

	(void)state;
	line_rate_init(&rate, 1 << 20);
	carry(&rate, 100000, 2000);
	carry(&rate, 5000, 250); /* a quarter of a second of something else on the line */
	carry(&rate, 100000, 1000);
	CHECK(is_about(&rate, 100000));
	carry(&rate, 2000000, 250); /* what a buffer had kept */
	carry(&rate, 100000, 1000);
	CHECK(is_about(&rate, 100000));
	carry(&rate, 0, 3000); /* nothing comes: no rate */
	CHECK(is_about(&rate, 100000));
}

static void pauses_do_not_count(void **state)
{
	struct line_rate rate;

	(void)state;
	line_rate_init(&rate, 1 << 20);
	for (int i = 0; i < 20; i++) {
		line_rate_note(&rate, received, true);
		now_ms += 40; /* a round trip */
		carry(&rate, 100000, 100);
		line_rate_note(&rate, received, false);
		now_ms += 1000;
		line_rate_note(&rate, received, false);
	}
	CHECK(is_about(&rate, 100000));
}

/* On a long line a turn comes in one piece, and then nothing until the next one was asked for. */
static void round_trips_do_not_count(void **state)
{
	struct line_rate rate;

	(void)state;
	line_rate_init(&rate, 1 << 20);
	line_rate_note(&rate, received, true);
	carry(&rate, 40000, 600);
	for (int turn = 0; turn < 60; turn++) {
		const uint64_t bytes = line_rate_carries(&rate, 500);

		now_ms += 300;
		carry(&rate, 125000, (int)(bytes / 125));
	}
	CHECK(rate.bytes_per_s > 95000 && rate.bytes_per_s < 130000);
}

/* Each packet of such a line comes after a silence. */
static void a_line_that_becomes_slow_is_noticed(void **state)
{
	struct line_rate rate;

	(void)state;
	line_rate_init(&rate, 1 << 20);
	line_rate_note(&rate, received, true);
	carry(&rate, 100000, 2000);
	for (int packet = 0; packet < 40; packet++) {
		now_ms += 362;
		received += 1448;
		line_rate_note(&rate, received, true);
	}
	CHECK(rate.bytes_per_s > 3600 && rate.bytes_per_s < 6000);
}

/* The answers of a start are smaller than a packet, a round trip each. */
static void small_answers_tell_nothing(void **state)
{
	struct line_rate rate;

	(void)state;
	line_rate_init(&rate, 1 << 20);
	for (int i = 0; i < 9; i++) {
		line_rate_note(&rate, received, true);
		now_ms += 300;
		received += 400;
		line_rate_note(&rate, received, true);
		now_ms += 300;
		received += 300;
		line_rate_note(&rate, received, i % 2 == 0);
	}
	CHECK(!rate.is_measured && rate.bytes_per_s == 1 << 20);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(takes_the_first_sample_as_it_is),
		cmocka_unit_test(follows_a_line_that_changes),
		cmocka_unit_test(sets_noise_aside),
		cmocka_unit_test(pauses_do_not_count),
		cmocka_unit_test(round_trips_do_not_count),
		cmocka_unit_test(a_line_that_becomes_slow_is_noticed),
		cmocka_unit_test(small_answers_tell_nothing),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
