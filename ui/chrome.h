/* What is always there, always in the same place: home, back, help, search, tours, tools, large
 * type, reach and the languages, on one bar at the lower left, where a seated visitor reaches it
 * too; and the help it shows. */
#ifndef GOPURA_UI_CHROME_H
#define GOPURA_UI_CHROME_H

#include "ui/bitmap.h"
#include "ui/theme.h"

enum { CHROME_LANGUAGES_MAX = 8 }; /* side by side; more are behind one button */
enum { CHROME_BUTTONS_MAX = CHROME_LANGUAGES_MAX + 9 };

enum chrome_button_kind {
	CHROME_HOME,
	CHROME_BACK, /* there is one or not: it is dim then */
	CHROME_HELP,
	CHROME_SEARCH,
	CHROME_TOURS,
	CHROME_LIGHT,
	CHROME_SECTION,
	CHROME_LARGE,
	CHROME_REACH,
	CHROME_LANGUAGE,
	CHROME_LANGUAGES, /* all of them */
};

struct chrome_button {
	enum chrome_button_kind kind;
	int language;       /* index, else -1 */
	int x_px, width_px; /* on the bar; as high as the bar */
};

struct chrome {
	struct chrome_button buttons[CHROME_BUTTONS_MAX];
	uint32_t button_count;
	int width_px, height_px;
	bool codes;    /* no room for the languages' names: their codes */
	bool usual;    /* no room for large type: labels at their usual size */
	bool tight;    /* not even for those at full size: no button wider than a finger */
	bool menu;     /* nor for those, or too many: one button stands for all languages */
	bool toolless; /* nor for those: the tools are left out */
};

/* What there is beside home, back, help, large type and languages. */
struct chrome_has {
	bool search, tours, light, section, reach;
};

/* languages are borrowed for the call. One language alone needs no switch. */
void chrome_layout(struct chrome *out, const struct theme *theme, const char *const *languages,
		   uint32_t language_count, int most_width_px, struct chrome_has has);

struct chrome_state {
	int language; /* index of the one that is set */
	bool back, help, search, tours, large, reach, light, section, languages;
};

/* A fresh bitmap of the bar; what is on is shown so. */
must_check int chrome_draw(struct bitmap *out, const struct chrome *chrome,
			   const struct theme *theme, const char *const *languages,
			   struct chrome_state state);
/* NULL: between the buttons. x relative to the bar. */
const struct chrome_button *chrome_button_at(const struct chrome *chrome, float x_px);

#endif
