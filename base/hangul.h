/* Korean: a syllable is one character of Unicode (The Unicode Standard, 3.12) and several letters
 * that are typed one after another. Letters are those of the block Hangul Compatibility Jamo,
 * U+3131 to U+3163, as they stand on keys; letters that are two on keys (ㄳ, ㅘ) count as two. */
#ifndef GOPURA_BASE_HANGUL_H
#define GOPURA_BASE_HANGUL_H

#include <stddef.h>
#include <stdint.h>

enum { HANGUL_LETTERS_MAX = 5 }; /* of a syllable: 뷁 is ㅂ ㅜ ㅔ ㄹ ㄱ */

/* The letters that a syllable or letter is typed with, in their order; 0 where c is neither. The
 * letters of normalization forms (U+1100 on) count as those of keys. */
size_t hangul_letters(uint32_t c, uint32_t letters[HANGUL_LETTERS_MAX]);

/* Letters into as few syllables as they make, as Korean keyboards do: a consonant before a vowel
 * begins a syllable. What makes none stays a letter, and so does what is no letter. In place;
 * returns how many characters are left. */
size_t hangul_compose(uint32_t *text, size_t count);

#endif
