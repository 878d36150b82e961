/* State and functions that the overlay's sources share. Private to ui. */
#ifndef GOPURA_UI_OVERLAY_STATE_H
#define GOPURA_UI_OVERLAY_STATE_H

#include "ui/article.h"
#include "ui/callout.h"
#include "ui/card.h"
#include "ui/chrome.h"
#include "ui/fade.h"
#include "ui/keyboard.h"
#include "ui/languages_view.h"
#include "ui/overlay.h"
#include "ui/screen.h"
#include "ui/theme.h"

enum { STRIPS = 16, LABELS = 64, STRIP_PX = 256 };
enum { OVERLAY_HIDDEN_MS = 1500 }; /* how long a callout stays after its part is hidden */
enum { SEARCH_ROWS = 16, SEARCH_ROWS_A_FRAME = 2, SEARCH_QUERY_BYTES = 128 };

enum { TOUR_CAPTION_BYTES = 1024 };

enum gallery_button { GALLERY_CLOSE, GALLERY_BACK, GALLERY_ON, GALLERY_BUTTONS };
enum { GALLERY_SLOTS = 3 }; /* the current picture and its neighbours */

enum bitmap_id {
	BITMAP_LEADER,
	BITMAP_DOT,
	BITMAP_CHROME,
	BITMAP_HELP,
	BITMAP_FINGER, /* the fingertip on the help */
	BITMAP_INVITATION,
	BITMAP_QUESTION,
	BITMAP_CARD,
	BITMAP_PAPER,
	BITMAP_PAGE_HEAD,
	BITMAP_PAGE_FOOT, /* text fades out if there is more below */
	BITMAP_SCROLL,
	BITMAP_SEARCH_HEAD,
	BITMAP_KEYBOARD,
	BITMAP_KEY, /* highlight over the key that was pressed */
	BITMAP_NIGHT,
	BITMAP_PICTURE_WORDS,
	BITMAP_TOUR,
	BITMAP_TOURS,
	BITMAP_DISC, /* one per tool */
	BITMAP_KNOB = BITMAP_DISC + OVERLAY_TOOL_COUNT,
	BITMAP_PUSH,
	BITMAP_CUT,
	BITMAP_PICTURE,
	BITMAP_PICTURE_BUTTON = BITMAP_PICTURE + GALLERY_SLOTS,
	BITMAP_STRIP = BITMAP_PICTURE_BUTTON + GALLERY_BUTTONS,
	BITMAP_ROW = BITMAP_STRIP + STRIPS,
	BITMAP_LABEL = BITMAP_ROW + SEARCH_ROWS,
	BITMAP_COUNT = BITMAP_LABEL + LABELS,
};

struct part {
	char *title, *caption, *thumbnail; /* owned */
	bool has_page;
	int label_px;  /* width of the label */
	float size_px; /* this and the following: as in struct overlay_anchor */
	bool in_view, hidden;
};

struct label {
	int part; /* -1: the label is free */
	bool drawn, drawn_selected;
	struct fade fade, dim; /* dim.on: its part is hidden */
	int64_t hidden_ms;     /* how long it has been hidden */
	struct callout place;
};

struct strip {
	int index;  /* number of the piece of the article, or -1 */
	bool stale; /* the article changed there: redraw; the old drawing shows until then */
	struct fade fade;
};

struct search_row {
	int part, index; /* the part and the row drawn on it; part -1: nothing yet */
	bool stale;
	struct fade fade;
};

struct search {
	struct fade fade; /* on: it is open */
	char query[SEARCH_QUERY_BYTES];
	struct keyboard keyboard;
	int pressed; /* the last pressed key, or -1 */
	struct fade press;
	uint32_t *found; /* owned; room for every part */
	uint32_t found_count;
	struct search_row rows[SEARCH_ROWS];
	float scroll_px, scroll_px_per_s;
	bool head_dirty, keyboard_dirty;
};

struct gallery_slot {
	int picture; /* the picture drawn or requested; -1: none */
	struct fade fade;
};

struct gallery {
	struct fade fade; /* on: it is open */
	int at, count;
	float zoom, x_px, y_px; /* zoom 1: it fits; x_px, y_px: its centre relative to the view's */
	float swipe_px;         /* offset of a swipe to the next picture, or back */
	bool dragging, words_dirty;
	struct gallery_slot slots[GALLERY_SLOTS]; /* picture % GALLERY_SLOTS */
};

struct tour_entry {
	char *title, *caption, *thumbnail; /* owned */
};

struct tours_menu {
	struct fade fade; /* on: it is open */
	struct tour_entry entries[OVERLAY_TOURS_MAX];
	uint32_t count;
	bool dirty;
};

struct tour_panel {
	struct fade fade; /* fade.on: nothing else takes its place */
	bool on, paused, dirty;
	int tour, stop, stop_count;
	char caption[TOUR_CAPTION_BYTES];
};

struct tools_panel {
	unsigned offered;
	struct overlay_tools now;
	struct fade fade[OVERLAY_TOOL_COUNT]; /* fade.on: the disc is visible */
	struct rect drawn;                    /* the size for which the discs were drawn */
	bool dirty;
};

struct overlay {
	int width_px, height_px;
	struct picture_source pictures;
	struct theme theme;
	struct overlay_comfort comfort;
	struct languages languages;

	struct part *parts;
	uint32_t part_count;
	struct callout_anchor *anchors; /* one per part */
	bool callouts_dirty;
	int column_px; /* width of the widest label */
	struct callouts callouts;
	struct label labels[LABELS];

	struct chrome chrome;
	bool chrome_dirty, help_dirty, card_dirty, head_dirty;
	struct fade help, card, page, invitation, question;
	int64_t help_ms;                  /* how long its fingers have moved */
	int question_s, question_drawn_s; /* seconds to show; seconds on its bitmap */
	int card_part, card_shown;        /* card_shown: on its bitmap, also while fading out */
	bool back;                        /* the back button is active */
	int page_part, page_titled;       /* page_titled: in its head, also while fading out */
	bool page_wide;                   /* also while fading out */
	struct article *article;          /* NULL when no page is open or fading out */
	struct strip strips[STRIPS];
	int strip_px;
	float scroll_px, scroll_px_per_s;
	struct search search;
	struct gallery gallery;
	struct tools_panel tools;
	struct tours_menu tours;
	struct languages_view languages_view;
	struct tour_panel tour;

	struct sprite sprites[BITMAP_COUNT];
	int64_t then_ms; /* time of the last update; 0: none yet */
};

/* The layout as it is now. */
struct screen overlay_screen(const struct overlay *overlay);
/* Places of the elements, pixels of the panel (overlay_place.c). */
bool overlay_is_portrait(const struct overlay *overlay);
/* In reach mode, the line below which all controls are; else 0. */
int overlay_reach_top(const struct overlay *overlay);
/* Returns true if the panel is large enough for reach mode. */
bool overlay_offers_reach(const struct overlay *overlay);
/* Reach mode on a wide panel: page and search lie flat, with their head beside the bar. */
bool overlay_is_flat(const struct overlay *overlay);
/* The place of a page or the search beside the model. */
struct rect overlay_half_rect(const struct overlay *overlay);
struct rect overlay_page_rect(const struct overlay *overlay); /* all of the paper */
struct rect
overlay_view_rect(const struct overlay *overlay); /* the visible window on the article */
/* The card, whether it is open or not. */
struct rect overlay_card_rect(const struct overlay *overlay);
/* The bar. */
struct rect overlay_chrome_rect(const struct overlay *overlay);
/* These three have the size of their bitmaps, which must be drawn before. */
struct rect overlay_help_rect(const struct overlay *overlay);
/* See above. */
struct rect overlay_invitation_rect(const struct overlay *overlay);
/* See above. */
struct rect overlay_question_rect(const struct overlay *overlay);
struct rect overlay_close_rect(const struct overlay *overlay); /* close control of the page */
/* The control that widens the page; empty if there is none. */
struct rect overlay_widen_rect(const struct overlay *overlay);
/* The head of a page or the search: the line with the control that closes it. */
struct rect overlay_head_rect(const struct overlay *overlay, struct rect paper);
/* The control that closes, at the end of a head. */
struct rect overlay_close_in(const struct overlay *overlay, struct rect head);
/* A rectangle of that size, centred in the scene, on the lowest line that the scene may use. */
struct rect overlay_above_floor(const struct overlay *overlay, int width_px, int height_px);
/* Returns the largest scroll position of the page; 0 without one. */
int overlay_scroll_most(const struct overlay *overlay);

/* Drawing (overlay_draw.c). Each call replaces a bitmap and raises its revision. */
void overlay_draw_fixed(struct overlay *overlay); /* all bitmaps that never change */
void overlay_draw_chrome(struct overlay *overlay);
/* Likewise; its size depends on language and scene. */
void overlay_draw_help(struct overlay *overlay);
void overlay_draw_invitation(struct overlay *overlay);
void overlay_draw_question(struct overlay *overlay);
/* The card of the part card_shown. */
void overlay_draw_card(struct overlay *overlay);
void overlay_draw_page_head(struct overlay *overlay);
/* One label; one strip of the article. */
void overlay_draw_label(struct overlay *overlay, uint32_t label);
void overlay_draw_strip(struct overlay *overlay, uint32_t slot);
/* Lays out the bar again (overlay.c). */
void overlay_lay_out_chrome(struct overlay *overlay);
/* Measures the labels of all parts. */
void overlay_measure_labels(struct overlay *overlay);
/* Drops all labels; they fade in again. */
void overlay_forget_labels(struct overlay *overlay);
/* Returns the width of a part's label. */
int overlay_measure_label(const struct overlay *overlay, const char *title);
/* Returns the height of a label. */
int overlay_row_px(const struct overlay *overlay);

/* Prepares a bitmap of that size for drawing. Returns NULL if memory runs out; else end with
 * overlay_end. */
cairo_t *overlay_begin(struct overlay *overlay, enum bitmap_id id, int width_px, int height_px);
/* Ends the drawing of a bitmap that overlay_begin returned a context for. */
void overlay_end(struct overlay *overlay, enum bitmap_id id, cairo_t *context);
/* Draws the control that closes a page or the search at the origin. */
void overlay_draw_close(const struct overlay *overlay, cairo_t *context, int width_px,
			int height_px);

/* overlay_search.c */
struct rect overlay_search_rect(const struct overlay *overlay); /* all of the paper */
struct rect overlay_keyboard_rect(const struct overlay *overlay);
struct rect overlay_found_rect(const struct overlay *overlay); /* the list of results */
/* Returns the height of a row of the list. */
int overlay_found_row_px(const struct overlay *overlay);
/* Returns the largest scroll position of the list. */
int overlay_found_scroll_most(const struct overlay *overlay);
/* Returns what a tap on the search means. */
struct overlay_action overlay_search_tap(const struct overlay *overlay, float x_px, float y_px);
/* The number of parts changed: makes room for results, and nothing is found yet. Returns -1 if
 * memory runs out. */
must_check int overlay_search_parts(struct overlay *overlay, uint32_t count);
/* Texts or sizes changed: redraw. */
void overlay_search_language(struct overlay *overlay);
/* A picture arrived: redraw the rows that show it. */
void overlay_search_picture(struct overlay *overlay, const char *name);
/* Updates one frame. Returns true if something still moves; so do the other update functions. */
bool overlay_update_search(struct overlay *overlay, int64_t step_ms);
/* Draw the search's head and keyboard. */
void overlay_draw_search_head(struct overlay *overlay);
void overlay_draw_keyboard(struct overlay *overlay);
/* Sets the place of the last pressed key. Returns false if there is none. */
bool overlay_pressed_rect(const struct overlay *overlay, struct rect *out);

/* overlay_gallery.c: the place of a picture that is not zoomed. */
struct rect overlay_gallery_rect(const struct overlay *overlay);
/* The place of one of its buttons. */
struct rect overlay_gallery_button(const struct overlay *overlay, enum gallery_button button);
/* Sets left, top, width, height of a picture. Returns false if it is not drawn yet. */
bool overlay_gallery_place(const struct overlay *overlay, int picture, float place_px[4]);
/* Returns what a tap on the gallery means. */
struct overlay_action overlay_gallery_tap(const struct overlay *overlay, float x_px, float y_px);
/* A picture arrived: redraw it if it is shown. */
void overlay_gallery_arrived(struct overlay *overlay, const char *name);
/* Draws the buttons once; they never change. */
void overlay_draw_gallery_buttons(struct overlay *overlay);
bool overlay_update_gallery(struct overlay *overlay, int64_t step_ms);

/* overlay_tour.c: the place of the tour's panel. */
struct rect overlay_tour_rect(const struct overlay *overlay);
/* The menu of tours. */
struct rect overlay_menu_rect(const struct overlay *overlay);
/* Returns true if a tour runs and nothing else takes the panel's place. */
bool overlay_tour_shows(const struct overlay *overlay);
/* Return what a tap on the panel or the menu means. */
struct overlay_action overlay_tour_tap(const struct overlay *overlay, float x_px, float y_px);
/* See above. */
struct overlay_action overlay_menu_tap(const struct overlay *overlay, float x_px, float y_px);
/* Frees the texts of OVERLAY_TOURS_MAX entries. */
void overlay_drop_tours(struct tour_entry *entries);
/* A picture arrived: redraw the menu if it shows it. */
void overlay_picture_of_tours(struct overlay *overlay, const char *name);
bool overlay_update_tours(struct overlay *overlay, int64_t step_ms);

/* overlay_tools.c: the knobs; centres in pixels of the panel. */
struct overlay_knobs {
	float light[2], turn[2], push[2];
	float along[2];          /* direction of the push, a unit vector */
	float line_px, thick_px; /* half the length and half the thickness of the section's line */
};
/* The place of a tool's disc. */
struct rect overlay_tool_rect(const struct overlay *overlay, int tool);
/* Returns true if the tool is on and its place is free. */
bool overlay_tool_shows(const struct overlay *overlay, int tool);
/* Top and left edge of the visible discs; the panel's height and width if there are none. */
int overlay_tools_top(const struct overlay *overlay);
int overlay_tools_left(const struct overlay *overlay);
/* Returns true if the point is on a visible disc. */
bool overlay_on_tools(const struct overlay *overlay, float x_px, float y_px);
/* Sets the centres of the knobs and the section's line. */
void overlay_tool_knobs(const struct overlay *overlay, struct overlay_knobs *out);
bool overlay_update_tools(struct overlay *overlay, int64_t step_ms);

/* Lays out the callouts and assigns them to labels (overlay_place.c). */
void overlay_lay_out_callouts(struct overlay *overlay);

#endif
