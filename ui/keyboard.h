/* A keyboard on the panel: one of their own for English, French, Khmer, Japanese (kana), Arabic,
 * Thai, Hindi, Korean, Russian, Ukrainian, Greek, Hebrew, Persian, Lao, Burmese and Tamil; Latin
 * letters for every other language. Whoever types other letters than Latin has those behind one
 * key. A key's target is never smaller than THEME_TARGET_MM, but where the panel itself is too
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
	int x_px, y_px, width_px, height_px; /* of its target, on the keyboard */
};

struct keyboard {
	struct keyboard_key keys[KEYBOARD_KEYS_MAX];
	uint32_t key_count;
	int width_px, height_px;
	bool latin; /* the letters behind KEY_LATIN are shown */
};

/* As wide as width_px, at most that tall. latin: the Latin letters of a language that has others.
 */
void keyboard_layout(struct keyboard *out, const struct theme *theme, const char *language,
		     bool latin, int width_px, int most_height_px);
must_check int keyboard_draw(struct bitmap *out, const struct keyboard *keyboard,
			     const struct theme *theme);
/* The key whose target that is, or -1. */
int keyboard_key_at(const struct keyboard *keyboard, float x_px, float y_px);

/* What the key does to a text of at most text_bytes, its end included; what does not fit is not
 * typed. Marks join the letter before them (か and ゛ are が), Korean letters their syllable, of
 * which one is taken back at a time. true: the text changed. */
bool keyboard_type(const struct keyboard_key *key, char *text, size_t text_bytes);

#endif
