/* Decodes the length of UTF-8 characters; refuses overlong forms and surrogates. */
#include "base/utf8.h"

size_t utf8_bytes(const char *text, size_t left)
{
	static const uint32_t least[] = { 0, 0, 0x80, 0x800, 0x10000 };
	const uint8_t first = left > 0 ? (uint8_t)*text : 0;
	const size_t n = first < 0x80 ? 1 : first >> 5 == 6 ? 2 : first >> 4 == 14 ? 3 : 4;
	uint32_t code = n == 1 ? first : first & (0xffu >> (n + 1));

	if (first < 0x20 || first == 0x7f || (n == 4 && first >> 3 != 30) || n > left)
		return 0;
	for (size_t i = 1; i < n; i++) {
		if (((uint8_t)text[i] & 0xc0) != 0x80)
			return 0;
		code = code << 6 | ((uint8_t)text[i] & 0x3f);
	}
	return n > 1 && (code < least[n] || code > 0x10ffff || (code >= 0xd800 && code < 0xe000))
		       ? 0
		       : n;
}

void utf8_cut(char *text, size_t bytes)
{
	size_t at = 0;

	while (text[at]) {
		const size_t n = utf8_bytes(text + at, SIZE_MAX);

		if (at + (n > 0 ? n : 1) > bytes)
			break;
		at += n > 0 ? n : 1;
	}
	text[at] = '\0';
}

void utf8_make_printable(char *text)
{
	while (*text) {
		const size_t n = utf8_bytes(text, SIZE_MAX);

		if (n == 0)
			*text = '?';
		text += n > 0 ? n : 1;
	}
}
