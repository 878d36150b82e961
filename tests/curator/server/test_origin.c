#include "curator/server/origin.h"

#include "base/compiler.h"

#include "tests/check.h"

static struct origin_names local(void)
{
	struct origin_names names = { 0 };

	CHECK(origin_add(&names, "127.0.0.1", 8780, false));
	CHECK(origin_add(&names, "localhost", 8780, false));
	return names;
}

static void its_own_page_and_programs_are_welcome(void **state)
{
	const struct origin_names names = local();

	(void)state;
	CHECK(origin_is_welcome(&names, "127.0.0.1:8780", ""));
	CHECK(origin_is_welcome(&names, "LocalHost:8780", "http://localhost:8780"));
}

static void other_names_and_other_pages_are_not(void **state)
{
	static const char *const bad[][2] = {
		{ "", "" },
		{ "evil.example:8780", "" },
		{ "127.0.0.1", "" },
		{ "127.0.0.1:8781", "" },
		{ "127.0.0.1:8780", "null" },
		{ "127.0.0.1:8780", "http://evil.example" },
		{ "127.0.0.1:8780", "http://localhost:8780" },
		{ "127.0.0.1:8780", "https://127.0.0.1:8780" },
		{ "127.0.0.1:8780", "http://127.0.0.1:8780.evil.example" },
	};
	const struct origin_names names = local();

	(void)state;
	for (unsigned n = 0; n < ARRAY_COUNT(bad); n++)
		CHECK(!origin_is_welcome(&names, bad[n][0], bad[n][1]));
}

static void a_name_behind_a_proxy_may_be_https(void **state)
{
	struct origin_names names = local();

	(void)state;
	CHECK(origin_add(&names, "curator.museum.example", 0, true));
	CHECK(origin_is_welcome(&names, "curator.museum.example",
				"https://curator.museum.example"));
	CHECK(!origin_is_welcome(&names, "curator.museum.example", "https://museum.example"));
}

static void a_name_is_a_host_name_or_an_address(void **state)
{
	static const char *const bad[] = { "", "a b", "http://a", "a/b", "a\n", "*" };
	struct origin_names names = { 0 };

	(void)state;
	for (unsigned n = 0; n < ARRAY_COUNT(bad); n++)
		CHECK(!origin_add(&names, bad[n], 0, true));
	CHECK(names.count == 0);
	for (unsigned n = 0; n < ORIGIN_NAMES_MAX; n++)
		CHECK(origin_add(&names, "[::1]", 80, true));
	CHECK(!origin_add(&names, "one.more", 0, true));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(its_own_page_and_programs_are_welcome),
		cmocka_unit_test(other_names_and_other_pages_are_not),
		cmocka_unit_test(a_name_behind_a_proxy_may_be_https),
		cmocka_unit_test(a_name_is_a_host_name_or_an_address),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
