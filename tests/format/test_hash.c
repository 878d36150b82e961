#include "format/hash.h"

#include <errno.h>
#include <string.h>

#include "tests/check.h"

static void is_blake2b_of_128_bits(void **state)
{
	/* b2sum -l 128 of nothing and of "abc". */
	char hex[HASH_HEX_BYTES];

	(void)state;
	hash_to_hex(hash_of((struct bytes){ NULL, 0 }), hex);
	CHECK(strcmp(hex, "cae66941d9efbd404e4d88758ea67670") == 0);
	hash_to_hex(hash_of((struct bytes){ (const uint8_t *)"abc", 3 }), hex);
	CHECK(strcmp(hex, "cf4ab791c62b8d2b2109c90275287816") == 0);
}

static void hex_goes_both_ways(void **state)
{
	struct hash hash = hash_of((struct bytes){ (const uint8_t *)"stone", 5 }), back;
	char hex[HASH_HEX_BYTES];

	(void)state;
	hash_to_hex(hash, hex);
	CHECK(hash_from_hex(&back, hex) == 0);
	CHECK(hash_equal(hash, back) && hash_compare(hash, back) == 0);
	CHECK(!hash_is_zero(hash) && hash_is_zero((struct hash){ 0 }));
	CHECK(hash_equal(hash_from_key(hash_key(hash)), hash));
}

static void refuses_what_is_not_32_lower_case_digits(void **state)
{
	static const char *const bad[] = {
		"",
		"0",
		"cae66941d9efbd404e4d88758ea6767",
		"cae66941d9efbd404e4d88758ea676700",
		"CAE66941D9EFBD404E4D88758EA67670",
		"cae66941d9efbd404e4d88758ea6767g",
		" ae66941d9efbd404e4d88758ea67670",
	};
	struct hash out;

	(void)state;
	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++)
		CHECK(hash_from_hex(&out, bad[i]) == -EBADMSG);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(is_blake2b_of_128_bits),
		cmocka_unit_test(hex_goes_both_ways),
		cmocka_unit_test(refuses_what_is_not_32_lower_case_digits),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
