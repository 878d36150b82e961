/* The bar of controls that is always visible in the same place: home, back, help, search, tours,
 * tools, large type, reach and the languages. It is at the lower left, where a seated visitor
 * reaches it too. */
#ifndef GOPURA_UI_BAR_VIEW_H
#define GOPURA_UI_BAR_VIEW_H

#include "ui/action.h"
#include "ui/languages.h"
#include "ui/layers.h"
#include "ui/screen.h"

enum { BAR_LANGUAGES_MAX = 8 }; /* side by side; more are behind one button */
enum { BAR_BUTTONS_MAX = BAR_LANGUAGES_MAX + 11 };

enum bar_view_button_kind {
	BAR_HOME,
	BAR_BACK, /* dim if there is no way back */
	BAR_HELP,
	BAR_SEARCH,
	BAR_TOURS,
	BAR_LIGHT,
	BAR_SECTION,
	BAR_MEASURE,
	BAR_WALK,
	BAR_LARGE,
	BAR_REACH,
	BAR_LANGUAGE,
	BAR_LANGUAGES, /* opens the menu of all languages */
};

struct bar_view_button {
	enum bar_view_button_kind kind;
	int language;       /* index of the language, else -1 */
	int x_px, width_px; /* relative to the bar; as high as the bar */
};

/* The buttons that exist beside home, back, help, large type and languages. */
struct bar_view_has {
	bool search, tours, light, section, measure, walk, reach;
};

/* The buttons that are highlighted, and back, which is dim without. */
struct bar_view_state {
	bool back, help, search, tours, large, reach, light, section, measure, walk, languages;
};

struct bar_view {
	struct bar_view_button buttons[BAR_BUTTONS_MAX];
	uint32_t button_count;
	int width_px, height_px;
	bool codes;    /* no room for the languages' names: show their codes */
	bool usual;    /* no room for large type either: labels in normal size */
	bool tight;    /* still too wide: no button is wider than a touch target */
	bool menu;     /* still too wide, or too many languages: one button for all */
	bool toolless; /* still too wide: the tools are left out */
	bool dirty;    /* draw it again */
	struct bar_view_state drawn;
	int drawn_language;
	struct sprite sprite;
};

void bar_view_init(struct bar_view *view, uint32_t *next_id);
void bar_view_finish(struct bar_view *view);

/* Lays the bar out, so that it fits beside an open page if possible; the flags of struct bar_view
 * say what was given up for that. A single language gets no button. screen needs neither bar nor
 * scene. */
void bar_view_lay_out(struct bar_view *view, const struct screen *screen,
		      const struct languages *languages, struct bar_view_has has);
struct rect bar_view_rect(const struct bar_view *view, const struct theme *theme, int height_px);
/* Returns what a tap on the bar means. back: there is a way back. */
struct overlay_action bar_view_tap(const struct bar_view *view, const struct screen *screen,
				   const struct languages *languages, bool back, float x_px);
/* Draws the bar if it was laid out anew or shows another state now. */
void bar_view_update(struct bar_view *view, const struct screen *screen,
		     const struct languages *languages, struct bar_view_state state);
void bar_view_layers(const struct bar_view *view, const struct screen *screen,
		     struct layers *layers);

#endif
