/* Lengths of characters, and texts that are cut. */
#include "base/utf8.h"

#include <stdlib.h>
#include <string.h>

#include "base/compiler.h"
#include "tests/check.h"

static void knows_the_length_of_a_character(void **state)
{
	(void)state;
	CHECK(utf8_bytes("a", SIZE_MAX) == 1 && utf8_bytes("é", SIZE_MAX) == 2 &&
	      utf8_bytes("ក", SIZE_MAX) == 3);
	CHECK(utf8_bytes("\xf0\x9f\x8f\x9b", SIZE_MAX) == 4);
	CHECK(utf8_bytes("\xf4\x8f\xbf\xbf", SIZE_MAX) == 4); /* U+10FFFF, the last one */
}

static void refuses_what_is_no_character(void **state)
{
	static const char *const bad[] = {
		"",
		"\n",
		"\x7f",
		"\x80",
		"\xc3",
		"\xc3(",
		"\xe1\x9e",
		"\xc0\x80",
		"\xc1\xbf",
		"\xe0\x9f\xbf",
		"\xf0\x8f\xbf\xbf",
		"\xed\xa0\x80", /* a surrogate */
		"\xff",
		"\xfe\xff",
		"\xf4\x90\x80\x80",
		"\xf8\x88\x80\x80",
	};

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(bad); i++)
		if (utf8_bytes(bad[i], SIZE_MAX) != 0)
			fail_msg("case %zu: %zu", i, utf8_bytes(bad[i], SIZE_MAX));
}

static void reads_no_further_than_told(void **state)
{
	static const char temple[] = { '\xf0', '\x9f', '\x8f', '\x9b' };

	(void)state;
	for (size_t left = 0; left <= sizeof(temple); left++) {
		char *exact = malloc(left ? left : 1); /* no slack for ASan */

		memcpy(exact, temple, left);
		CHECK(utf8_bytes(exact, left) == (left == sizeof(temple) ? left : 0));
		free(exact);
	}
}

static void cuts_between_characters(void **state)
{
	static const char *const expected[] = { "", "a", "a", "a", "aក", "aក", "aកé", "aកé" };

	(void)state;
	for (size_t bytes = 0; bytes < ARRAY_COUNT(expected); bytes++) {
		char text[] = "aកé";

		utf8_cut(text, bytes);
		if (strcmp(text, expected[bytes]) != 0)
			fail_msg("%zu: '%s'", bytes, text);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(knows_the_length_of_a_character),
		cmocka_unit_test(refuses_what_is_no_character),
		cmocka_unit_test(reads_no_further_than_told),
		cmocka_unit_test(cuts_between_characters),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
