/* Splits text of any language into the words that a search uses. Case, accents and widths are
 * folded ("Nâga", "NAGA" and "naga" are the same word). Katakana and small kana become hiragana,
 * Arabic loses its vowel signs, Korean syllables are split into letters. In scripts without spaces
 * (Khmer, Thai, Lao, Burmese, ideographs and kana) every character is a word. A sequence of them is
 * then found by any part of it while it is typed, and no dictionary of word boundaries is
 * needed. */
#ifndef GOPURA_STORAGE_WORDS_H
#define GOPURA_STORAGE_WORDS_H

#include "base/bytes.h"

enum {
	WORDS_QUERY_BYTES_MAX = 256, /* of a query; the rest is ignored */
	WORDS_QUERY_MAX = 16,        /* words in a query */
};

/* Appends the words with a space before each. Text that is not UTF-8 ends there. Returns -ENOMEM or
 * -EFBIG. */
must_check int words_of(struct buffer *out, const char *text);

/* Appends an FTS5 expression that matches if every word of the text begins a word (or occurs in a
 * sequence of a script without spaces). Appends nothing if there is no word. Returns -ENOMEM or
 * -EFBIG. */
must_check int words_query(struct buffer *out, const char *text);

#endif
