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

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(takes_the_first_sample_as_it_is),
		cmocka_unit_test(follows_a_line_that_changes),
		cmocka_unit_test(sets_noise_aside),
		cmocka_unit_test(pauses_do_not_count),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
