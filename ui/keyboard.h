/* An on-screen keyboard. English, French, Khmer, Japanese (kana), Arabic, Thai, Hindi, Korean,
 * Russian, Ukrainian, Greek, Hebrew, Persian, Lao, Burmese and Tamil have their own; every other
 * language gets Latin letters. A keyboard with other letters than Latin has the Latin ones behind
 * one key. A key's target is never smaller than THEME_TARGET_MM, unless the panel itself is too
 * small for that. */
#ifndef GOPURA_UI_KEYBOARD_H
#define GOPURA_UI_KEYBOARD_H

#include "ui/bitmap.h"
#include "ui/theme.h"

enum { KEYBOARD_KEYS_MAX = 96 };

enum keyboard_key_kind { KEY_TEXT, KEY_SPACE, KEY_BACKSPACE, KEY_LATIN };

struct keyboard_key {
	enum keyboard_key_kind kind;
	char text[8];                        /* KEY_TEXT: UTF-8 */
	int x_px, y_px, width_px, height_px; /* its touch target, relative to the keyboard */
};

struct keyboard {
	struct keyboard_key keys[KEYBOARD_KEYS_MAX];
	uint32_t key_count;
	int width_px, height_px;
	bool latin; /* the Latin letters behind KEY_LATIN are shown */
};

/* Lays out a keyboard that is width_px wide and at most most_height_px high. latin: show the Latin
 * letters of a language that has others. */
void keyboard_layout(struct keyboard *out, const struct theme *theme, const char *language,
		     bool latin, int width_px, int most_height_px);
/* Draws the keyboard into a new bitmap, owned by the caller. Returns the errors of bitmap_init. */
must_check int keyboard_draw(struct bitmap *out, const struct keyboard *keyboard,
			     const struct theme *theme);
/* Returns the index of the key at that point, or -1. */
int keyboard_key_at(const struct keyboard *keyboard, float x_px, float y_px);

/* Applies a key to text, which has room for text_bytes with its final zero. What does not fit is
 * not typed. Marks join the letter before them (か and ゛ give が). Korean letters join their
 * syllable, and backspace removes them one at a time. Returns true if the text changed. */
bool keyboard_type(const struct keyboard_key *key, char *text, size_t text_bytes);

#endif
