#include "net/token_bucket.h"

#include <string.h>

#include "tests/check.h"
#include "tests/net/fake_http.h"

static struct token_bucket bucket;

static void begin(uint64_t bytes_per_s)
{
	memset(&server, 0, sizeof(server));
	server.now_ms = 1000;
	token_bucket_init(&bucket, bytes_per_s);
}

static void without_a_limit_it_is_never_empty(void **state)
{
	(void)state;
	begin(0);
	for (int i = 0; i < 5; i++)
		token_bucket_take(&bucket, UINT32_MAX);
	token_bucket_refill(&bucket);
	CHECK(!token_bucket_is_empty(&bucket) && token_bucket_due_ms(&bucket) == 0);
}

static void saves_half_a_second_and_no_more(void **state)
{
	(void)state;
	begin(1000);
	server.now_ms += 60000;
	token_bucket_refill(&bucket);
	token_bucket_take(&bucket, 499);
	CHECK(!token_bucket_is_empty(&bucket));
	token_bucket_take(&bucket, 1);
	CHECK(token_bucket_is_empty(&bucket));
}

static void an_overdraft_is_paid_back_before_the_next_request(void **state)
{
	(void)state;
	begin(1000);
	token_bucket_take(&bucket, 2500); /* 2000 too many: 2 seconds */
	CHECK(token_bucket_due_ms(&bucket) == 1000 + 2000 + 1);
	server.now_ms += 2000;
	token_bucket_refill(&bucket);
	CHECK(token_bucket_is_empty(&bucket) && token_bucket_due_ms(&bucket) == server.now_ms + 1);
	server.now_ms = token_bucket_due_ms(&bucket);
	token_bucket_refill(&bucket);
	CHECK(!token_bucket_is_empty(&bucket));
}

/* Every request goes out as soon as it may. */
static void keeps_the_average(void **state)
{
	uint64_t taken = 0;

	(void)state;
	begin(6000);
	while (server.now_ms < 1000 + 100000) {
		token_bucket_refill(&bucket);
		if (!token_bucket_is_empty(&bucket)) {
			token_bucket_take(&bucket, 3000);
			taken += 3000;
		}
		if (token_bucket_due_ms(&bucket) > server.now_ms)
			server.now_ms = token_bucket_due_ms(&bucket);
	}
	CHECK(taken >= 100 * 6000 && taken <= 100 * 6000 + 3000 + 3000);
}

static void a_long_sleep_at_a_high_rate_does_not_overflow(void **state)
{
	(void)state;
	begin(1ull << 34);
	token_bucket_take(&bucket, UINT32_MAX);
	token_bucket_take(&bucket, UINT32_MAX);
	token_bucket_take(&bucket, UINT32_MAX);
	CHECK(token_bucket_is_empty(&bucket));
	server.now_ms += 1ll << 40;
	token_bucket_refill(&bucket);
	CHECK(!token_bucket_is_empty(&bucket));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(without_a_limit_it_is_never_empty),
		cmocka_unit_test(saves_half_a_second_and_no_more),
		cmocka_unit_test(an_overdraft_is_paid_back_before_the_next_request),
		cmocka_unit_test(keeps_the_average),
		cmocka_unit_test(a_long_sleep_at_a_high_rate_does_not_overflow),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
