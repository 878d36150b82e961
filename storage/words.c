/* Normalises text with GLib's Unicode functions and splits it into search words and FTS5
 * queries. */
#include "storage/words.h"

#include <errno.h>
#include <glib.h>
#include <stdlib.h>
#include <string.h>

#include "base/hangul.h"

/* Letters without a Unicode decomposition, and what people type instead. */
static const struct {
	gunichar from;
	const char *to;
} spellings[] = {
	{ 0xdf, "ss" }, { 0xe6, "ae" }, { 0x153, "oe" }, { 0xf8, "o" },
	{ 0x111, "d" }, { 0x142, "l" }, { 0x131, "i" },  { 0x629, "ه" },
	{ 0x649, "ي" }, { 0x6cc, "ي" }, { 0x6a9, "ك" },  { 0x3c2, "σ" },
};

static bool is_between(gunichar c, gunichar first, gunichar last)
{
	return c >= first && c <= last;
}

/* Returns true for marks that people leave out when they search (of Latin, Greek, Cyrillic and
 * Arabic), and for invisible characters such as the zero-width space. */
static bool is_left_out(gunichar c)
{
	return is_between(c, 0x300, 0x36f) || is_between(c, 0x64b, 0x65f) || c == 0x670 ||
	       c == 0x640 || c == 0xad || is_between(c, 0x200b, 0x200f) || c == 0x2060 ||
	       is_between(c, 0xfe00, 0xfe0f) || c == 0xfeff;
}

/* Thai, Lao, Burmese, Khmer, kana, ideographs: each character is a word. */
static bool is_without_spaces(gunichar c)
{
	return is_between(c, 0xe00, 0xeff) || is_between(c, 0x1000, 0x109f) ||
	       is_between(c, 0x1780, 0x17d3) || c == 0x17dd || c == 0x3005 ||
	       is_between(c, 0x3041, 0x309f) || is_between(c, 0x30a1, 0x30fa) ||
	       is_between(c, 0x30fc, 0x30ff) || is_between(c, 0x3400, 0x9fff) ||
	       is_between(c, 0xf900, 0xfaff) || is_between(c, 0x20000, 0x3ffff);
}

static bool is_of_a_word(gunichar c)
{
	return g_unichar_isalnum(c) || g_unichar_ismark(c);
}

static gunichar fold(gunichar c)
{
	static const gunichar small_kana[] = { 0x3041, 0x3043, 0x3045, 0x3047, 0x3049,
					       0x3063, 0x3083, 0x3085, 0x3087, 0x308e };
	gunichar base, mark;

	c = g_unichar_tolower(c);
	while (g_unichar_decompose(c, &base, &mark) && mark != 0 && is_left_out(mark))
		c = base;
	if (is_between(c, 0x30a1, 0x30f6)) /* katakana to hiragana */
		c -= 0x60;
	for (size_t i = 0; i < ARRAY_COUNT(small_kana); i++)
		if (small_kana[i] == c)
			return c + 1; /* each comes directly before the large one */
	return c;
}

/* Writes Korean as letters, so that half a syllable finds what it may become. */
static void put_char(struct buffer *out, gunichar c)
{
	uint32_t letters[HANGUL_LETTERS_MAX];
	const size_t count = hangul_letters(c, letters);
	char utf8[6];

	for (size_t i = 0; i < count; i++)
		buffer_put(out, utf8, (size_t)g_unichar_to_utf8(letters[i], utf8));
	if (count > 0)
		return;

	for (size_t i = 0; i < ARRAY_COUNT(spellings); i++)
		if (spellings[i].from == c) {
			buffer_put_text(out, spellings[i].to);
			return;
		}
	buffer_put(out, utf8, (size_t)g_unichar_to_utf8(c, utf8));
}

int words_of(struct buffer *out, const char *text)
{
	const char *end;
	char *composed;
	bool inside = false;

	g_utf8_validate(text, -1, &end);
	composed = g_utf8_normalize(text, end - text, G_NORMALIZE_NFKC);
	for (const char *p = composed; p && *p; p = g_utf8_next_char(p)) {
		gunichar c = fold(g_utf8_get_char(p));
		bool alone = is_without_spaces(c);

		if (is_left_out(c))
			continue;
		if (!is_of_a_word(c) && !alone) {
			inside = false;
			continue;
		}
		if (alone || !inside)
			buffer_put_u8(out, ' ');
		put_char(out, c);
		inside = !alone;
	}
	g_free(composed);
	return out->error;
}

/* Writes one piece of the query as a phrase whose last word may continue. */
static int put_phrase(struct buffer *out, const char *piece, bool *is_first)
{
	struct buffer words;
	int rc;

	buffer_init(&words, 8 * WORDS_QUERY_BYTES_MAX);
	rc = words_of(&words, piece);
	if (rc == 0 && words.size > 0) {
		buffer_put(out, *is_first ? "\"" : " AND \"", *is_first ? 1 : 6);
		buffer_put(out, words.data + 1, words.size - 1);
		buffer_put(out, "\"*", 2);
		*is_first = false;
		rc = out->error;
	}
	buffer_finish(&words);
	return rc;
}

int words_query(struct buffer *out, const char *text)
{
	char *copy = strndup(text, WORDS_QUERY_BYTES_MAX), *rest = copy, *piece;
	bool is_first = true;
	int rc = copy ? 0 : -ENOMEM;

	for (int i = 0; rc == 0 && i < WORDS_QUERY_MAX;) {
		piece = strsep(&rest, " \t\r\n");
		if (!piece)
			break;
		if (*piece) {
			rc = put_phrase(out, piece, &is_first);
			i++;
		}
	}
	free(copy);
	return rc;
}
