/* The few words that are the kiosk's own, and what languages call themselves. */
#ifndef GOPURA_UI_STRINGS_H
#define GOPURA_UI_STRINGS_H

enum ui_string {
	UI_READ_MORE,
	UI_CLOSE,
	UI_HELP_TURN,
	UI_HELP_ZOOM,
	UI_HELP_TAP,
	UI_TOUCH,       /* the invitation */
	UI_STILL_THERE, /* asked of a visitor who does nothing */
	UI_ANEW,        /* %d seconds */
	UI_GO_ON,
	UI_SEARCH,
	UI_NOTHING_FOUND,
	UI_TOURS,
	UI_LIGHT, /* the tools */
	UI_SECTION,
	UI_STRING_COUNT,
};

/* "pt-BR" as "pt"; in English where the language is not among ours. Never NULL. */
const char *ui_string(enum ui_string string, const char *language);
/* "ខ្មែរ" for "km"; the code itself where we do not know better. */
const char *ui_endonym(const char *language);

#endif
