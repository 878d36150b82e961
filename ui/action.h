/* What a tap means: the answer of a view, which the app carries out. */
#ifndef GOPURA_UI_ACTION_H
#define GOPURA_UI_ACTION_H

enum overlay_action_kind {
	OVERLAY_NONE,      /* not on the overlay: the tap is the model's */
	OVERLAY_SWALLOWED, /* on the overlay, but nothing happens */
	OVERLAY_OPEN_CARD, /* part: a callout was tapped */
	OVERLAY_OPEN_PAGE, /* part: its card was tapped */
	OVERLAY_CLOSE_CARD,
	OVERLAY_CLOSE_PAGE,
	OVERLAY_WIDEN_PAGE, /* toggle the whole-panel page (overlay_page_is_wide) */
	OVERLAY_LISTEN,     /* begin or end the spoken text of the page */
	OVERLAY_LANGUAGE,   /* set language */
	OVERLAY_LANGUAGES,  /* toggle their menu (overlay_choosing_language) */
	OVERLAY_LINK,       /* link: a link's target, a part's id or "tour:" and a tour's id */
	OVERLAY_HOME,       /* go to the first view */
	OVERLAY_BACK,       /* go back; only where that is offered */
	OVERLAY_HELP,       /* toggle the help (overlay_help) */
	OVERLAY_SEARCH,     /* toggle the search (overlay_searching) */
	OVERLAY_LARGE,      /* toggle large type (overlay_comfort) */
	OVERLAY_REACH,      /* toggle reach mode */
	OVERLAY_LIGHT,      /* toggle this tool */
	OVERLAY_SECTION,    /* toggle this tool */
	OVERLAY_MEASURE,    /* toggle this tool */
	OVERLAY_WALK,       /* toggle this tool */
	OVERLAY_CHOICE,     /* choice: this state of the site was chosen */
	OVERLAY_KEY,        /* key: for overlay_press */
	OVERLAY_FOUND,      /* part: a search result was tapped */
	OVERLAY_PICTURE,    /* picture: for overlay_show_picture */
	OVERLAY_TOURS,      /* toggle the menu; while a tour runs, the tour goes on */
	OVERLAY_TOUR,       /* tour: it was chosen */
	OVERLAY_TOUR_PAUSE, /* pause or resume the tour */
	OVERLAY_TOUR_CLOSE,
};

enum { OVERLAY_KEY_CLEAR = -1 }; /* the field's clear control */

struct overlay_action {
	enum overlay_action_kind kind;
	int part;             /* else -1 */
	int key;              /* for OVERLAY_KEY */
	int picture;          /* for OVERLAY_PICTURE */
	int tour;             /* for OVERLAY_TOUR */
	unsigned choice;      /* for OVERLAY_CHOICE */
	const char *language; /* borrowed until the overlay is destroyed; else NULL */
	const char *link;     /* borrowed until the page changes; else NULL */
};

/* The handles of the tools. A finger that touches one keeps it until it lifts. */
enum overlay_handle {
	OVERLAY_HANDLE_NONE,
	OVERLAY_HANDLE_LIGHT,
	OVERLAY_HANDLE_PUSH,
	OVERLAY_HANDLE_TURN,
	OVERLAY_HANDLE_FROM, /* one end of what is measured */
	OVERLAY_HANDLE_TO,   /* the other */
};

#endif
