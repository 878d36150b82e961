#include "curator/server/request_head.h"

#include "tests/check.h"

static void a_length_is_digits_alone(void **state)
{
	static const char *const bad[] = { "",   "-1",   "+1",  " 1",
					   "1 ", "0x10", "1e3", "1234567890123" };
	uint64_t length;

	(void)state;
	for (unsigned n = 0; n < ARRAY_COUNT(bad); n++)
		CHECK(!request_head_length(bad[n], &length));
	CHECK(request_head_length("0", &length) && length == 0);
	CHECK(request_head_length("999999999999", &length) && length == 999999999999);
}

static void gzip_is_sent_to_whoever_takes_it(void **state)
{
	static const char *const yes[] = { "gzip", "gzip, deflate, br", "br;q=1.0, gzip;q=0.8",
					   "gzip ; q=0.001" };
	static const char *const no[] = { "", "br", "gzip;q=0", "gzip; q=0.0, br", "gzip;q=0.000" };

	(void)state;
	for (unsigned n = 0; n < ARRAY_COUNT(yes); n++)
		CHECK(request_head_takes_gzip(yes[n]));
	for (unsigned n = 0; n < ARRAY_COUNT(no); n++)
		CHECK(!request_head_takes_gzip(no[n]));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_length_is_digits_alone),
		cmocka_unit_test(gzip_is_sent_to_whoever_takes_it),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
