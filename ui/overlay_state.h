/* Private to ui: what the overlay's sources share. */
#ifndef GOPURA_UI_OVERLAY_STATE_H
#define GOPURA_UI_OVERLAY_STATE_H

#include "ui/article.h"
#include "ui/callout.h"
#include "ui/card.h"
#include "ui/chrome.h"
#include "ui/keyboard.h"
#include "ui/overlay.h"
#include "ui/theme.h"

enum { STRIPS = 16, LABELS = 64, STRIP_PX = 256 };
enum { OVERLAY_HIDDEN_MS = 1500 }; /* that a callout outlasts its part */
enum { SEARCH_ROWS = 16, SEARCH_ROWS_A_FRAME = 2, SEARCH_QUERY_BYTES = 128 };

enum { TOUR_CAPTION_BYTES = 1024 };

enum gallery_button { GALLERY_CLOSE, GALLERY_BACK, GALLERY_ON, GALLERY_BUTTONS };
enum { GALLERY_SLOTS = 3 }; /* the picture that is looked at and its neighbours */

enum bitmap_id {
	BITMAP_LEADER,
	BITMAP_DOT,
	BITMAP_CHROME,
	BITMAP_HELP,
	BITMAP_FINGER, /* on it */
	BITMAP_INVITATION,
	BITMAP_QUESTION,
	BITMAP_CARD,
	BITMAP_PAPER,
	BITMAP_PAGE_HEAD,
	BITMAP_PAGE_FOOT, /* text fades out where there is more below */
	BITMAP_SCROLL,
	BITMAP_SEARCH_HEAD,
	BITMAP_KEYBOARD,
	BITMAP_KEY, /* over the one that was pressed */
	BITMAP_NIGHT,
	BITMAP_PICTURE_WORDS,
	BITMAP_TOUR,
	BITMAP_TOURS,
	BITMAP_LANGUAGES,
	BITMAP_DISC, /* a tool each */
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

struct drawing {
	struct bitmap bitmap; /* empty: could not be drawn, left out */
	uint32_t revision;
};

struct fade {
	float alpha;
	bool on;
};

struct part {
	char *title, *caption, *thumbnail; /* owned */
	bool has_page;
	int label_px;  /* width of its label */
	float size_px; /* this and what follows: as struct overlay_anchor has it */
	bool in_view, hidden;
};

struct label {
	int part; /* -1: free */
	bool drawn, drawn_selected;
	struct fade fade, dim; /* dim: its part is hidden */
	int64_t hidden_ms;     /* for which that is so */
	struct callout place;
};

struct strip {
	int index;  /* which piece of the article, or -1 */
	bool stale; /* the article changed there: draw it again, show the old until then */
	struct fade fade;
};

struct search_row {
	int part, index; /* what is drawn on it; part -1: nothing yet */
	bool stale;
	struct fade fade;
};

struct search {
	struct fade fade; /* on: it is open */
	char query[SEARCH_QUERY_BYTES];
	struct keyboard keyboard;
	int pressed; /* the key that was pressed last, or -1 */
	struct fade press;
	uint32_t *found; /* owned; room for every part */
	uint32_t found_count;
	struct search_row rows[SEARCH_ROWS];
	float scroll_px, scroll_px_per_s;
	bool head_dirty, keyboard_dirty;
};

struct gallery_slot {
	int picture; /* that was drawn, or asked for; -1: none */
	struct fade fade;
};

struct gallery {
	struct fade fade; /* on: it is open */
	int at, count;
	float zoom, x_px, y_px; /* 1: it fits; of its middle from the view's */
	float swipe_px;         /* on its way to the next, or back to its place */
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

struct languages_menu {
	struct fade fade; /* on: it is open */
	bool dirty;
};

struct tour_panel {
	struct fade fade; /* on: nothing else has its place */
	bool on, paused, dirty;
	int tour, stop, stop_count;
	char caption[TOUR_CAPTION_BYTES];
};

struct tools_panel {
	unsigned offered;
	struct overlay_tools now;
	struct fade fade[OVERLAY_TOOL_COUNT]; /* on: what is open leaves its place */
	struct overlay_rect drawn;            /* as large as the discs' bitmaps are */
	bool dirty;
};

struct overlay {
	int width_px, height_px;
	struct picture_source pictures;
	struct theme theme;
	struct overlay_comfort comfort;
	char *languages[OVERLAY_LANGUAGES_MAX];
	uint32_t language_count;
	int language; /* index of the one that is set */

	struct part *parts;
	uint32_t part_count;
	struct callout_anchor *anchors; /* as many as parts */
	bool callouts_dirty;
	int column_px; /* of the widest label */
	struct callouts callouts;
	struct label labels[LABELS];

	struct chrome chrome;
	bool chrome_dirty, help_dirty, card_dirty, head_dirty;
	struct fade help, card, page, invitation, question;
	int64_t help_ms;                  /* for which its fingers have moved */
	int question_s, question_drawn_s; /* on the count-down; on its bitmap */
	int card_part, card_shown;        /* shown: on its bitmap, also while fading out */
	bool back;                        /* is offered */
	int page_part, page_titled;       /* titled: in its head, also while fading out */
	bool page_wide;                   /* likewise */
	struct article *article;          /* NULL when no page is open or fading out */
	struct strip strips[STRIPS];
	int strip_px;
	float scroll_px, scroll_px_per_s;
	struct search search;
	struct gallery gallery;
	struct tools_panel tools;
	struct tours_menu tours;
	struct languages_menu menu;
	struct tour_panel tour;

	struct drawing drawings[BITMAP_COUNT];
	int64_t then_ms; /* of the last update; 0: none yet */
};

/* Where things are; pixels of the panel. */
bool overlay_is_portrait(const struct overlay *overlay);
/* In reach mode the line below which everything is that can be touched; else 0. */
int overlay_reach_top(const struct overlay *overlay);
bool overlay_offers_reach(const struct overlay *overlay);
/* Reach mode on a panel that is wide: what is open lies flat, its head beside the bar. */
bool overlay_is_flat(const struct overlay *overlay);
struct overlay_rect overlay_half_rect(const struct overlay *overlay);
struct overlay_rect overlay_page_rect(const struct overlay *overlay); /* all of its paper */
struct overlay_rect overlay_view_rect(const struct overlay *overlay); /* window on the article */
struct overlay_rect overlay_card_rect(const struct overlay *overlay);
struct overlay_rect overlay_chrome_rect(const struct overlay *overlay);
struct overlay_rect overlay_help_rect(const struct overlay *overlay);
struct overlay_rect overlay_invitation_rect(const struct overlay *overlay);
struct overlay_rect overlay_question_rect(const struct overlay *overlay);
struct overlay_rect overlay_close_rect(const struct overlay *overlay); /* of the page */
struct overlay_rect overlay_widen_rect(const struct overlay *overlay);
/* Of a page or the search: the line with the control that closes it. */
struct overlay_rect overlay_head_rect(const struct overlay *overlay, struct overlay_rect paper);
/* The control that closes, at the end of a head. */
struct overlay_rect overlay_close_in(const struct overlay *overlay, struct overlay_rect head);
bool overlay_rect_holds(struct overlay_rect rect, float x_px, float y_px);
/* In the middle of the scene, on the lowest line that it may use. */
struct overlay_rect overlay_above_floor(const struct overlay *overlay, int width_px, int height_px);
int overlay_scroll_most(const struct overlay *overlay);

/* Bitmaps; each replaces what was there and raises the revision. */
void overlay_draw_fixed(struct overlay *overlay); /* leader, dot, paper, foot, scroll mark */
void overlay_draw_chrome(struct overlay *overlay);
void overlay_draw_help(struct overlay *overlay);
void overlay_draw_invitation(struct overlay *overlay);
void overlay_draw_question(struct overlay *overlay);
void overlay_draw_card(struct overlay *overlay);
void overlay_draw_page_head(struct overlay *overlay);
void overlay_draw_label(struct overlay *overlay, uint32_t label);
void overlay_draw_strip(struct overlay *overlay, uint32_t slot);
void overlay_lay_out_chrome(struct overlay *overlay);
void overlay_measure_labels(struct overlay *overlay);
/* All come in anew. */
void overlay_forget_labels(struct overlay *overlay);
/* Width of a part's label. */
int overlay_measure_label(const struct overlay *overlay, const char *title);
int overlay_row_px(const struct overlay *overlay);

/* Makes room for a new picture of that size; NULL where there is no memory. */
cairo_t *overlay_begin(struct overlay *overlay, enum bitmap_id id, int width_px, int height_px);
void overlay_end(struct overlay *overlay, enum bitmap_id id, cairo_t *context);
/* The control that closes a page or the search, at the origin. */
void overlay_draw_close(const struct overlay *overlay, cairo_t *context, int width_px,
			int height_px);
/* true: still on its way. */
bool overlay_advance(struct fade *fade, int64_t step_ms);

/* overlay_search.c */
struct overlay_rect overlay_search_rect(const struct overlay *overlay); /* all of its paper */
struct overlay_rect overlay_keyboard_rect(const struct overlay *overlay);
struct overlay_rect overlay_found_rect(const struct overlay *overlay); /* the list */
int overlay_found_row_px(const struct overlay *overlay);
int overlay_found_scroll_most(const struct overlay *overlay);
struct overlay_action overlay_search_tap(const struct overlay *overlay, float x_px, float y_px);
/* Other parts: nothing is found yet. -1: no memory. */
must_check int overlay_search_parts(struct overlay *overlay, uint32_t count);
void overlay_search_language(struct overlay *overlay);
void overlay_search_picture(struct overlay *overlay, const char *name);
bool overlay_update_search(struct overlay *overlay, int64_t step_ms);
void overlay_draw_search_head(struct overlay *overlay);
void overlay_draw_keyboard(struct overlay *overlay);
bool overlay_pressed_rect(const struct overlay *overlay, struct overlay_rect *out);

/* overlay_gallery.c */
struct overlay_rect overlay_gallery_rect(const struct overlay *overlay);
struct overlay_rect overlay_gallery_button(const struct overlay *overlay,
					   enum gallery_button button);
bool overlay_gallery_place(const struct overlay *overlay, int picture, float place_px[4]);
struct overlay_action overlay_gallery_tap(const struct overlay *overlay, float x_px, float y_px);
void overlay_gallery_arrived(struct overlay *overlay, const char *name);
void overlay_draw_gallery_buttons(struct overlay *overlay);
bool overlay_update_gallery(struct overlay *overlay, int64_t step_ms);

/* overlay_tour.c */
struct overlay_rect overlay_tour_rect(const struct overlay *overlay);
struct overlay_rect overlay_menu_rect(const struct overlay *overlay);
bool overlay_tour_shows(const struct overlay *overlay);
struct overlay_action overlay_tour_tap(const struct overlay *overlay, float x_px, float y_px);
struct overlay_action overlay_menu_tap(const struct overlay *overlay, float x_px, float y_px);
void overlay_drop_tours(struct tour_entry *entries);
void overlay_picture_of_tours(struct overlay *overlay, const char *name);
bool overlay_update_tours(struct overlay *overlay, int64_t step_ms);

/* overlay_languages.c */
struct overlay_rect overlay_languages_rect(const struct overlay *overlay);
struct overlay_action overlay_languages_tap(const struct overlay *overlay, float x_px, float y_px);
bool overlay_update_languages(struct overlay *overlay, int64_t step_ms);

/* overlay_tools.c */
struct overlay_knobs {
	float light[2], turn[2], push[2];
	float along[2];          /* the push's way, a unit vector */
	float line_px, thick_px; /* half of what the section's line is long and thick */
};
struct overlay_rect overlay_tool_rect(const struct overlay *overlay, int tool);
bool overlay_tool_shows(const struct overlay *overlay, int tool);
/* Of those that show: the panel's own height and width where none does. */
int overlay_tools_top(const struct overlay *overlay);
int overlay_tools_left(const struct overlay *overlay);
bool overlay_on_tools(const struct overlay *overlay, float x_px, float y_px);
void overlay_tool_knobs(const struct overlay *overlay, struct overlay_knobs *out);
bool overlay_update_tools(struct overlay *overlay, int64_t step_ms);

/* Callouts into labels. true: some wait to be drawn. */
void overlay_lay_out_callouts(struct overlay *overlay);

#endif
