/* Korean syllables and letters: a syllable is one Unicode character (The Unicode Standard, 3.12),
 * but is typed as several letters. Letters are those of the block Hangul Compatibility Jamo, U+3131
 * to U+3163, as they are printed on keys; letters that take two keys (ㄳ, ㅘ) count as two. */
#ifndef GOPURA_BASE_HANGUL_H
#define GOPURA_BASE_HANGUL_H

#include <stddef.h>
#include <stdint.h>

enum { HANGUL_LETTERS_MAX = 5 }; /* most letters of a syllable: 뷁 is ㅂ ㅜ ㅔ ㄹ ㄱ */

/* Writes the letters with which a syllable or letter is typed, in their order, and returns their
 * number; 0 if c is neither. Letters of the normalization forms (from U+1100) count as those of the
 * keys. */
size_t hangul_letters(uint32_t c, uint32_t letters[HANGUL_LETTERS_MAX]);

/* Composes letters into as few syllables as possible, as Korean keyboards do: a consonant before a
 * vowel begins a syllable. Letters that form no syllable and other characters stay as they are.
 * Works in place; returns the number of characters left. */
size_t hangul_compose(uint32_t *text, size_t count);

#endif
