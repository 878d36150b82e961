/* Splits Korean syllables into their letters and composes letters into syllables, with the
 * arithmetic and the tables of Unicode. */
#include "base/hangul.h"

#include <stdbool.h>

#include "base/compiler.h"

enum {
	SYLLABLE_FIRST = 0xac00,
	SYLLABLE_COUNT = 19 * 21 * 28,
	VOWEL_FIRST = 0x314f, /* ㅏ; the 21 vowels, in the order of the syllables */
	VOWELS = 21,
};

/* Consonants that begin a syllable, and those that end one, in the order of the syllables. */
static const uint16_t leads[19] = { 0x3131, 0x3132, 0x3134, 0x3137, 0x3138, 0x3139, 0x3141,
				    0x3142, 0x3143, 0x3145, 0x3146, 0x3147, 0x3148, 0x3149,
				    0x314a, 0x314b, 0x314c, 0x314d, 0x314e };
static const uint16_t tails[28] = { 0,      0x3131, 0x3132, 0x3133, 0x3134, 0x3135, 0x3136,
				    0x3137, 0x3139, 0x313a, 0x313b, 0x313c, 0x313d, 0x313e,
				    0x313f, 0x3140, 0x3141, 0x3142, 0x3144, 0x3145, 0x3146,
				    0x3147, 0x3148, 0x314a, 0x314b, 0x314c, 0x314d, 0x314e };

/* Pairs of keys that form one letter: ㅗ ㅏ ㅘ … ㅡ ㅣ ㅢ, ㄱ ㅅ ㄳ … ㅂ ㅅ ㅄ. */
static const struct {
	uint16_t first, second, both;
} pairs[] = {
	{ 0x3157, 0x314f, 0x3158 }, { 0x3157, 0x3150, 0x3159 }, { 0x3157, 0x3163, 0x315a },
	{ 0x315c, 0x3153, 0x315d }, { 0x315c, 0x3154, 0x315e }, { 0x315c, 0x3163, 0x315f },
	{ 0x3161, 0x3163, 0x3162 }, { 0x3131, 0x3145, 0x3133 }, { 0x3134, 0x3148, 0x3135 },
	{ 0x3134, 0x314e, 0x3136 }, { 0x3139, 0x3131, 0x313a }, { 0x3139, 0x3141, 0x313b },
	{ 0x3139, 0x3142, 0x313c }, { 0x3139, 0x3145, 0x313d }, { 0x3139, 0x314c, 0x313e },
	{ 0x3139, 0x314d, 0x313f }, { 0x3139, 0x314e, 0x3140 }, { 0x3142, 0x3145, 0x3144 },
};

static bool is_letter(uint32_t c)
{
	return c >= 0x3131 && c <= 0x3163;
}

static bool is_vowel(uint32_t c)
{
	return c >= VOWEL_FIRST && c < VOWEL_FIRST + VOWELS;
}

/* Converts a letter of the normalization forms, where its position in the syllable is part of the
 * code, to the letter of the keys. Other characters are returned unchanged. */
static uint32_t plain(uint32_t c)
{
	if (c >= 0x1100 && c < 0x1100 + ARRAY_COUNT(leads))
		return leads[c - 0x1100];
	if (c >= 0x1161 && c < 0x1161 + VOWELS)
		return VOWEL_FIRST + (c - 0x1161);
	if (c > 0x11a7 && c < 0x11a7 + ARRAY_COUNT(tails))
		return tails[c - 0x11a7];
	return c;
}

static int find(const uint16_t *letters, int count, uint32_t c)
{
	for (int i = 0; i < count; i++)
		if (letters[i] == c)
			return i;
	return -1;
}

/* Returns the letter that the two form, or 0. */
static uint32_t join(uint32_t first, uint32_t second)
{
	for (size_t i = 0; i < ARRAY_COUNT(pairs); i++)
		if (pairs[i].first == first && pairs[i].second == second)
			return pairs[i].both;
	return 0;
}

static size_t put_keys(uint32_t *letters, size_t count, uint32_t c)
{
	for (size_t i = 0; i < ARRAY_COUNT(pairs); i++)
		if (pairs[i].both == c) {
			letters[count++] = pairs[i].first;
			letters[count++] = pairs[i].second;
			return count;
		}
	letters[count++] = c;
	return count;
}

size_t hangul_letters(uint32_t c, uint32_t letters[HANGUL_LETTERS_MAX])
{
	const uint32_t index = c - SYLLABLE_FIRST;
	size_t count = 0;

	if (is_letter(plain(c)))
		return put_keys(letters, 0, plain(c));
	if (c < SYLLABLE_FIRST || index >= SYLLABLE_COUNT)
		return 0;
	count = put_keys(letters, count, leads[index / (VOWELS * 28)]);
	count = put_keys(letters, count, VOWEL_FIRST + index / 28 % VOWELS);
	if (index % 28 != 0)
		count = put_keys(letters, count, tails[index % 28]);
	return count;
}

/* Returns the letter at text, or the one it forms with the next, and adds the letters taken to *at.
 */
static uint32_t take(const uint32_t *text, size_t left, size_t *at)
{
	const uint32_t both = left > 1 ? join(text[0], text[1]) : 0;

	*at += both ? 2 : 1;
	return both ? both : text[0];
}

/* Returns the index of the final consonant of a syllable, 0 for none, and adds the letters taken to
 * *at. A consonant before a vowel begins the next syllable. */
static int take_tail(const uint32_t *text, size_t left, size_t *at)
{
	const uint32_t both = left > 1 ? join(text[0], text[1]) : 0;
	const bool begins_next = left > 1 && is_vowel(text[1]);

	if (left == 0 || begins_next)
		return 0;
	if (both && !(left > 2 && is_vowel(text[2]))) {
		*at += 2;
		return find(tails, ARRAY_COUNT(tails), both);
	}
	const int tail = find(tails, ARRAY_COUNT(tails), text[0]);

	*at += tail > 0;
	return tail > 0 ? tail : 0;
}

size_t hangul_compose(uint32_t *text, size_t count)
{
	size_t to = 0;

	for (size_t at = 0; at < count;) {
		const int lead = find(leads, ARRAY_COUNT(leads), text[at]);

		if (lead < 0 || at + 1 >= count || !is_vowel(text[at + 1])) {
			text[to++] = text[at++];
			continue;
		}
		at++;
		const uint32_t vowel = take(text + at, count - at, &at) - VOWEL_FIRST;
		const int tail = take_tail(text + at, count - at, &at);

		text[to++] =
			SYLLABLE_FIRST + ((uint32_t)lead * VOWELS + vowel) * 28 + (uint32_t)tail;
	}
	return to;
}
