#include "curator/server/request_head.h"

#include <string.h>

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

static void finds_a_cookie_among_others(void **state)
{
	char out[8];

	(void)state;
	CHECK(request_head_cookie("a=1; name=secret; b=2", "name", out, sizeof(out)));
	CHECK(strcmp(out, "secret") == 0);
	CHECK(request_head_cookie("name=", "name", out, sizeof(out)) && !*out);
	CHECK(request_head_cookie("x=name=1;name=2", "name", out, sizeof(out)));
	CHECK(strcmp(out, "2") == 0);
	CHECK(!request_head_cookie("", "name", out, sizeof(out)) && !*out);
	CHECK(!request_head_cookie("rename=1; names=2; name", "name", out, sizeof(out)));
	CHECK(!request_head_cookie("name=too long for it", "name", out, sizeof(out)) && !*out);
}

static void an_address_is_its_network(void **state)
{
	static const char *const cases[][2] = {
		{ "192.0.2.7", "192.0.2.7" },
		{ "::ffff:192.0.2.7", "192.0.2.7" },
		{ "2001:db8:1:2:3:4:5:6", "2001:db8:1:2::" },
		{ "localhost", "" },
		{ "", "" },
		{ "192.0.2.7 ", "" },
	};
	char out[API_ADDRESS_BYTES];

	(void)state;
	for (unsigned n = 0; n < ARRAY_COUNT(cases); n++) {
		request_head_address(cases[n][0], out);
		CHECK(strcmp(out, cases[n][1]) == 0);
	}
}

/* What stands before it was sent by the browser, which may say anything. */
static void the_last_forwarded_address_is_believed(void **state)
{
	char out[API_ADDRESS_BYTES];

	(void)state;
	request_head_forwarded("192.0.2.7", out);
	CHECK(strcmp(out, "192.0.2.7") == 0);
	request_head_forwarded("10.0.0.1, 198.51.100.1 ,192.0.2.7 ", out);
	CHECK(strcmp(out, "192.0.2.7") == 0);
	request_head_forwarded("192.0.2.7, unknown", out);
	CHECK(!*out);
	request_head_forwarded("", out);
	CHECK(!*out);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_length_is_digits_alone),
		cmocka_unit_test(gzip_is_sent_to_whoever_takes_it),
		cmocka_unit_test(finds_a_cookie_among_others),
		cmocka_unit_test(an_address_is_its_network),
		cmocka_unit_test(the_last_forwarded_address_is_believed),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
