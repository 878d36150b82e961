#include "base/uri.h"

#include <string.h>

#include "base/compiler.h"
#include "tests/check.h"

static void bytes_in_hexadecimal_become_bytes_and_all_else_stays(void **state)
{
	static const struct {
		const char *uri, *name;
	} cases[] = {
		{ "", "" },
		{ "skin.png", "skin.png" },
		{ "my%20skin%2epng", "my skin.png" },
		{ "caf%C3%a9", "caf\xc3\xa9" },
		{ "50%", "50%" },
		{ "50%2", "50%2" },
		{ "%g0%0g%%20", "%g0%0g% " },
		{ "a%00b", "a%00b" },
	};
	char name[32];
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(cases); i++)
		if (!uri_decode(name, sizeof(name), cases[i].uri) ||
		    strcmp(name, cases[i].name) != 0)
			fail_msg("%s: '%s'", cases[i].uri, name);
}

static void a_name_that_does_not_fit_is_refused(void **state)
{
	char name[4];
	(void)state;

	CHECK(uri_decode(name, sizeof(name), "a%20b") && strcmp(name, "a b") == 0);
	CHECK(!uri_decode(name, sizeof(name), "a%20bc") && strcmp(name, "a b") == 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(bytes_in_hexadecimal_become_bytes_and_all_else_stays),
		cmocka_unit_test(a_name_that_does_not_fit_is_refused),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
