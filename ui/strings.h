/* The kiosk's own texts in each language, and the languages' names for themselves. */
#ifndef GOPURA_UI_STRINGS_H
#define GOPURA_UI_STRINGS_H

enum ui_string {
	UI_READ_MORE,
	UI_CLOSE,
	UI_HELP_TURN,
	UI_HELP_ZOOM,
	UI_HELP_TAP,
	UI_TOUCH,       /* the invitation */
	UI_STILL_THERE, /* asked of an inactive visitor */
	UI_ANEW,        /* contains %d: seconds */
	UI_GO_ON,
	UI_SEARCH,
	UI_NOTHING_FOUND,
	UI_TOURS,
	UI_LIGHT, /* this and the next: names of the tools */
	UI_SECTION,
	UI_STRING_COUNT,
};

/* Returns a text in a language; "pt-BR" gets the text of "pt". English if the language is unknown.
 * Never NULL; static. */
const char *ui_string(enum ui_string string, const char *language);
/* Returns a language's own name, "ខ្មែរ" for "km". Returns the code itself if the name is
 * unknown. */
const char *ui_endonym(const char *language);

#endif
