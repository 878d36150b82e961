#include "net/redirect.h"

#include "tests/check.h"

static const char museum[] = "https://museum.example/temple", plain[] = "http://museum.example";

static void follows_the_same_host_and_port_only(void **state)
{
	static const struct {
		const char *to;
		bool allowed;
	} cases[] = {
		{ "https://museum.example/other", true },
		{ "https://MUSEUM.example:443/other", true },
		{ "https://museum.example:8443/other", false },
		{ "https://www.museum.example/", false },
		{ "https://museum.example.evil.example/", false },
		{ "https://museum.example@evil.example/", false },
		{ "https://guest:word@museum.example/", false },
		{ "http://museum.example/other", false },
		{ "https://192.168.1.1/admin", false },
		{ "https://[::1]/", false },
		{ "ftp://museum.example/", false },
		{ "file:///etc/passwd", false },
		{ "nonsense", false },
		{ "", false },
	};

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++)
		if (redirect_allowed(museum, museum, cases[i].to, NULL) != cases[i].allowed)
			fail_msg("%s", cases[i].to);
}

static void goes_from_http_to_https_and_never_back(void **state)
{
	(void)state;
	CHECK(redirect_allowed(plain, plain, "http://museum.example/x", ""));
	CHECK(redirect_allowed(plain, plain, "https://museum.example/x", ""));
	CHECK(!redirect_allowed(plain, plain, "http://museum.example:8080/x", ""));
	CHECK(!redirect_allowed(plain, plain, "https://museum.example:8443/x", ""));
	CHECK(!redirect_allowed(plain, "https://museum.example/x", "http://museum.example/x", ""));
	CHECK(!redirect_allowed(museum, museum, "http://cdn.example/x", "cdn.example:80"));
	CHECK(redirect_allowed(plain, plain, "http://cdn.example/x", "cdn.example"));
}

static void follows_hosts_that_were_named(void **state)
{
	static const char named[] = "cdn.example, other.example:8443";

	(void)state;
	CHECK(redirect_allowed(museum, museum, "https://cdn.example/x", named));
	CHECK(redirect_allowed(museum, "https://cdn.example/x", "https://museum.example/y", named));
	CHECK(!redirect_allowed(museum, museum, "https://cdn.example:8443/x", named));
	CHECK(redirect_allowed(museum, museum, "https://other.example:8443/x", named));
	CHECK(!redirect_allowed(museum, museum, "https://other.example/x", named));
	CHECK(!redirect_allowed(museum, museum, "https://example/x", named));
	CHECK(!redirect_allowed(museum, museum, "https://a.cdn.example/x", named));
}

/* A server that is asked with a name and a password keeps them in a redirection of its own. */
static void keeps_the_name_that_the_server_is_asked_with(void **state)
{
	static const char named[] = "https://guest:word@museum.example/temple";

	(void)state;
	CHECK(redirect_allowed(named, named, "https://guest:word@museum.example/x", NULL));
	CHECK(redirect_allowed(named, named, "https://museum.example/x", NULL));
	CHECK(!redirect_allowed(named, named, "https://other:word@museum.example/x", NULL));
	CHECK(!redirect_allowed(named, named, "https://guest:word@evil.example/x", NULL));
}

static void refuses_lists_that_name_no_hosts(void **state)
{
	static const char *const good[] = { "", "cdn.example", "192.168.1.4:8443,a,b,c:1" };
	static const char *const bad[] = { "https://cdn.example", "cdn.example:",   "cdn.example:0",
					   "cdn.example:65536",   "a,b,c,d,e",      "-cdn.example",
					   "cdn.example/x",       "cdn.example:1x", "*.example" };

	(void)state;
	CHECK(redirect_hosts_valid(NULL));
	for (size_t i = 0; i < ARRAY_COUNT(good); i++)
		if (!redirect_hosts_valid(good[i]))
			fail_msg("%s", good[i]);
	for (size_t i = 0; i < ARRAY_COUNT(bad); i++)
		if (redirect_hosts_valid(bad[i]))
			fail_msg("%s", bad[i]);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(follows_the_same_host_and_port_only),
		cmocka_unit_test(goes_from_http_to_https_and_never_back),
		cmocka_unit_test(follows_hosts_that_were_named),
		cmocka_unit_test(keeps_the_name_that_the_server_is_asked_with),
		cmocka_unit_test(refuses_lists_that_name_no_hosts),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
