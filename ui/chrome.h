/* The bar of controls that is always visible in the same place: home, back, help, search, tours,
 * tools, large type, reach and the languages. It is at the lower left, where a seated visitor
 * reaches it too. */
#ifndef GOPURA_UI_CHROME_H
#define GOPURA_UI_CHROME_H

#include "ui/bitmap.h"
#include "ui/theme.h"

enum { CHROME_LANGUAGES_MAX = 8 }; /* side by side; more are behind one button */
enum { CHROME_BUTTONS_MAX = CHROME_LANGUAGES_MAX + 9 };

enum chrome_button_kind {
	CHROME_HOME,
	CHROME_BACK, /* dim if there is no way back */
	CHROME_HELP,
	CHROME_SEARCH,
	CHROME_TOURS,
	CHROME_LIGHT,
	CHROME_SECTION,
	CHROME_LARGE,
	CHROME_REACH,
	CHROME_LANGUAGE,
	CHROME_LANGUAGES, /* opens the menu of all languages */
};

struct chrome_button {
	enum chrome_button_kind kind;
	int language;       /* index of the language, else -1 */
	int x_px, width_px; /* relative to the bar; as high as the bar */
};

struct chrome {
	struct chrome_button buttons[CHROME_BUTTONS_MAX];
	uint32_t button_count;
	int width_px, height_px;
	bool codes;    /* no room for the languages' names: show their codes */
	bool usual;    /* no room for large type either: labels in normal size */
	bool tight;    /* still too wide: no button is wider than a touch target */
	bool menu;     /* still too wide, or too many languages: one button for all */
	bool toolless; /* still too wide: the tools are left out */
};

/* The buttons that exist beside home, back, help, large type and languages. */
struct chrome_has {
	bool search, tours, light, section, reach;
};

/* Lays out the bar, at most most_width_px wide if possible; the flags of struct chrome say what was
 * given up for that. languages are borrowed for the call. A single language gets no button. */
void chrome_layout(struct chrome *out, const struct theme *theme, const char *const *languages,
		   uint32_t language_count, int most_width_px, struct chrome_has has);

struct chrome_state {
	int language; /* index of the current language */
	bool back, help, search, tours, large, reach, light, section, languages;
};

/* Draws the bar into a new bitmap, owned by the caller. Buttons that are on in state are
 * highlighted. Returns the errors of bitmap_init. */
must_check int chrome_draw(struct bitmap *out, const struct chrome *chrome,
			   const struct theme *theme, const char *const *languages,
			   struct chrome_state state);
/* Returns the button at x_px, relative to the bar, or NULL between buttons. Borrowed. */
const struct chrome_button *chrome_button_at(const struct chrome *chrome, float x_px);

#endif
