/* Korean letters and syllables: every syllable of Unicode from the letters it is typed with. */
#include "base/hangul.h"

#include <string.h>

#include "tests/check.h"

static void every_syllable_comes_from_its_letters(void **state)
{
	(void)state;
	for (uint32_t c = 0xac00; c <= 0xd7a3; c++) {
		uint32_t letters[HANGUL_LETTERS_MAX];
		const size_t count = hangul_letters(c, letters);

		CHECK(count >= 2 && count <= HANGUL_LETTERS_MAX);
		for (size_t i = 0; i < count; i++)
			CHECK(letters[i] >= 0x3131 && letters[i] <= 0x3163);
		CHECK(hangul_compose(letters, count) == 1 && letters[0] == c);
	}
}

static void a_vowel_takes_the_consonant_before_it(void **state)
{
	/* 닭 and ㅣ are 달기; 없 and ㅇ ㅓ are 없어. */
	uint32_t chicken[] = { 0x3137, 0x314f, 0x3139, 0x3131, 0x3163 };
	uint32_t none[] = { 0x3147, 0x3153, 0x3142, 0x3145, 0x3147, 0x3153 };

	(void)state;
	CHECK(hangul_compose(chicken, 5) == 2 && chicken[0] == 0xb2ec && chicken[1] == 0xae30);
	CHECK(hangul_compose(none, 6) == 2 && none[0] == 0xc5c6 && none[1] == 0xc5b4);
}

static void what_makes_no_syllable_stays(void **state)
{
	uint32_t text[] = { 'a', 0x3131, 0x3131, 0x314f, ' ', 0x3157, 0x314f, 0x3138 };
	uint32_t letters[HANGUL_LETTERS_MAX];

	(void)state;
	CHECK(hangul_compose(text, 8) == 7);
	CHECK(text[0] == 'a' && text[1] == 0x3131 && text[2] == 0xac00 && text[3] == ' ' &&
	      text[4] == 0x3157 && text[5] == 0x314f && text[6] == 0x3138);
	CHECK(hangul_compose(text, 0) == 0);
	for (uint32_t c = 0; c < 0x3131; c = c == 0x10ff ? 0x1200 : c + 1)
		CHECK(hangul_letters(c, letters) == 0);
	CHECK(hangul_letters(0xabff, letters) == 0 && hangul_letters(0xd7a4, letters) == 0);
	CHECK(hangul_letters(UINT32_MAX, letters) == 0);
}

/* Letters by their place in a syllable, as normalization has them. */
static void letters_of_normalization_are_those_of_keys(void **state)
{
	uint32_t letters[HANGUL_LETTERS_MAX];

	(void)state;
	CHECK(hangul_letters(0x1112, letters) == 1 && letters[0] == 0x314e);
	CHECK(hangul_letters(0x1175, letters) == 1 && letters[0] == 0x3163);
	CHECK(hangul_letters(0x11aa, letters) == 2 && letters[0] == 0x3131 && letters[1] == 0x3145);
	CHECK(hangul_letters(0x11a7, letters) == 0 && hangul_letters(0x11c3, letters) == 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_syllable_comes_from_its_letters),
		cmocka_unit_test(a_vowel_takes_the_consonant_before_it),
		cmocka_unit_test(what_makes_no_syllable_stays),
		cmocka_unit_test(letters_of_normalization_are_those_of_keys),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
