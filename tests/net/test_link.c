#include "net/link.h"

#include "tests/check.h"
#include "tests/net/fake_http.h"

static void pauses_longer_each_time_and_never_the_same(void **state)
{
	int64_t different = 0;

	(void)state;
	for (uint32_t n = 1; n < 40; n++) {
		int64_t middle = n < 8 ? 500ll << (n - 1) : 60000;

		middle = middle > 60000 ? 60000 : middle;
		for (int i = 0; i < 50; i++) {
			int64_t pause = link_pause_ms(n);

			CHECK(pause >= middle / 2 && pause <= middle / 2 + middle);
			different += pause != link_pause_ms(n);
		}
	}
	CHECK(different > 1000);
}

static void sends_one_request_to_look_after_a_failure(void **state)
{
	struct link link;

	(void)state;
	memset(&server, 0, sizeof(server));
	server.now_ms = 1000;
	link_init(&link);
	CHECK(!link.online && link_offline_since_s(&link) > 0 && link_may_request(&link));
	link_answered(&link);
	CHECK(link.online && link_offline_since_s(&link) == 0);
	link_failed(&link, "fake:", "cut");
	CHECK(!link.online && link_offline_since_s(&link) == 1700000001 &&
	      !link_may_request(&link));
	link_failed(&link, "fake:", "cut"); /* others that were under way */
	CHECK(link.failures == 1 && !link_is_down(&link));
	server.now_ms = link.retry_at_ms;
	CHECK(link_may_request(&link));
	link.in_flight = 1;
	CHECK(!link_may_request(&link));
	link.in_flight = 0;
	server.now_ms += 3000;
	link_failed(&link, "fake:", "cut");
	CHECK(link_is_down(&link) && link_offline_since_s(&link) == 1700000001);
	link_answered(&link);
	CHECK(link_may_request(&link) && !link_is_down(&link));
	CHECK(link.answers == 2 && link.errors == 3);
}

/* At a start the network may come last, so the first failure tells little. */
static void notes_why_it_failed_last(void **state)
{
	struct metrics_refusal refusal = { 0 };
	struct link link;

	(void)state;
	memset(&server, 0, sizeof(server));
	link_init(&link);
	link.refusal = &refusal;
	link_failed(&link, "https://museum/", "could not resolve host");
	server.now_ms = link.retry_at_ms;
	link_failed(&link, "https://museum/", "certificate has expired");
	CHECK(refusal.count == 2 && strcmp(refusal.what, "https://museum/") == 0);
	CHECK(strcmp(refusal.why, "certificate has expired") == 0);
}

static void knows_how_long_it_is_offline_by_whatever_clock(void **state)
{
	static const int64_t sets_s[] = { 86400, -86400, -1000 };
	struct link link;

	(void)state;
	memset(&server, 0, sizeof(server));
	server.now_ms = 1999;
	link_init(&link);
	CHECK(link_offline_since_s(&link) == 1700000001);
	for (size_t i = 0; i < ARRAY_COUNT(sets_s); i++) {
		uint64_t since_s;

		server.wall_ahead_s = sets_s[i];
		server.now_ms += 600001;
		since_s = link_offline_since_s(&link);
		CHECK(llabs(clock_wall_s() - (int64_t)since_s - 600 * (int64_t)(i + 1)) <= 1);
		server.now_ms += 999; /* and says the same until the clock is set again */
		CHECK(link_offline_since_s(&link) == since_s);
		server.now_ms -= 999;
	}
	server.wall_ahead_s = -1700000000; /* 1970 */
	CHECK(link_offline_since_s(&link) > 0 && link_offline_since_s(&link) < 1800);
	link_answered(&link);
	CHECK(link_offline_since_s(&link) == 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(pauses_longer_each_time_and_never_the_same),
		cmocka_unit_test(sends_one_request_to_look_after_a_failure),
		cmocka_unit_test(notes_why_it_failed_last),
		cmocka_unit_test(knows_how_long_it_is_offline_by_whatever_clock),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
