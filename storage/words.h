/* Text of any language into the words that a search finds it by. Case, accents and widths are
 * folded ("Nâga", "NAGA" and "naga" are one word), katakana and small kana are hiragana, Arabic is
 * without its vowel signs, Korean is apart in letters. Scripts that are written without spaces
 * (Khmer, Thai, Lao, Burmese, ideographs and kana) give a word a character: a run of them is then
 * found by any run inside it, as it is typed, and no dictionary has to know where words end. */
#ifndef GOPURA_STORAGE_WORDS_H
#define GOPURA_STORAGE_WORDS_H

#include "base/bytes.h"

enum {
	WORDS_QUERY_BYTES_MAX = 256, /* of a query that is looked at */
	WORDS_QUERY_MAX = 16,        /* words of it */
};

/* Appends the words with a space before each. What is not UTF-8 ends the text. -ENOMEM, -EFBIG. */
must_check int words_of(struct buffer *out, const char *text);

/* Appends an FTS5 expression that holds where every word of the text begins a word (or stands
 * anywhere in a run of a script without spaces). Nothing is appended where there is no word. */
must_check int words_query(struct buffer *out, const char *text);

#endif
