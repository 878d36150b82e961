/* Everything that is written over the model: callouts, the card, the page beside the model, the
 * search, the language switch, home and help. The overlay owns what is shown, draws it with Pango
 * and Cairo into bitmaps, and gives the app a list of textured quads. It knows no GL, no network
 * and no database: texts, pictures and the pixels of anchors are given to it, and a tap is answered
 * by an action that the app carries out.
 *
 * A frame:  overlay_anchors (if the camera moved)  ->  overlay_update  ->  overlay_layers.
 * One thread. Pixels are of the picture as the visitor sees it: x right, y down. */
#ifndef GOPURA_UI_OVERLAY_H
#define GOPURA_UI_OVERLAY_H

#include <stdbool.h>
#include <stdint.h>

#include "base/bytes.h"
#include "ui/bitmap.h"
#include "ui/source.h"

enum {
	OVERLAY_PARTS_MAX = 1000,
	OVERLAY_LANGUAGES_MAX = 64,
	OVERLAY_TOURS_MAX = 8,
	OVERLAY_LAYERS_MAX = 256,  /* in a frame */
	OVERLAY_BITMAPS_MAX = 128, /* bitmap ids are below this */
};

struct overlay_rect {
	int x_px, y_px, width_px, height_px;
};

struct overlay_options {
	int width_px, height_px;      /* of the panel; 320 .. 8192 */
	float px_per_mm;              /* of the panel; 0: guessed from its size */
	const char *const *languages; /* of the release, copied; the first is the default */
	uint32_t language_count;
	/* A picture by the name that a page or thumbnail gives ("pictures/gate.jpg"). false: there
	 * is none of that name. Asking is wanting: the app fetches it and calls
	 * overlay_picture_arrived. NULL: no pictures. */
	bool (*picture)(void *data, const char *name, struct overlay_picture *out);
	void *data;
};

struct overlay;

/* *out is owned by the caller; on failure it is NULL. -EINVAL, -ENOMEM. */
must_check int overlay_create(struct overlay **out, const struct overlay_options *options);
void overlay_destroy(struct overlay *overlay); /* NULL is fine */

/* ---- what it shows ---- */

struct overlay_part {
	const char *title, *caption; /* UTF-8; caption may be "" */
	const char *thumbnail;       /* a picture's name, or "" */
	bool has_page;
};

/* The parts, in order of importance, in the language that is set; copied. Card and page are
 * closed where the count changes. */
must_check int overlay_parts(struct overlay *overlay, const struct overlay_part *parts,
			     uint32_t count);
/* Its texts and marks; give the parts (and the page, if one is open) again in that language. */
void overlay_language(struct overlay *overlay, const char *language);

/* Where each part's anchor is on the panel now. As many as there are parts. */
struct overlay_anchor {
	float x_px, y_px;
	float size_px; /* across, of the part; 0: it is a mere place */
	bool visible;  /* before the eye, in the scene's rectangle */
	bool hidden;   /* behind the model: a callout that is there dims, and goes if it stays so */
};
void overlay_anchors(struct overlay *overlay, const struct overlay_anchor *anchors, uint32_t count);

/* The card of a part; -1 closes it. */
void overlay_show_card(struct overlay *overlay, int part);
int overlay_card(const struct overlay *overlay); /* the part whose card is open, or -1 */

/* Opens the page beside the model, or replaces the one that is open. html is parsed now and not
 * kept; credits, a line below it in small, is copied and may be "". -EBADMSG: nothing in it can be
 * shown; -ENOMEM. */
must_check int overlay_show_page(struct overlay *overlay, int part, struct bytes html,
				 const char *credits);
void overlay_close_page(struct overlay *overlay);
int overlay_page(const struct overlay *overlay); /* the part whose page is open, or -1 */

/* The page has the whole panel, or stands beside the model again, which it also does for a card and
 * in reach mode; the next page that is opened stands beside it. */
void overlay_widen_page(struct overlay *overlay, bool on);
bool overlay_page_is_wide(const struct overlay *overlay);

/* What of the page is above the first line that is seen, a share of it; 0 without one. */
float overlay_read(const struct overlay *overlay);
void overlay_read_from(struct overlay *overlay, float share);

/* How to touch the model, in pictures and words; on at first, off at the first touch. */
void overlay_show_help(struct overlay *overlay, bool on);
bool overlay_help(const struct overlay *overlay);

/* Nobody is there: the invitation to touch, in every language, where the help stands; the help is
 * there when it goes. Off at first. */
void overlay_invite(struct overlay *overlay, bool on);
/* Asks over everything whether somebody is still there, and counts down; -1: does not ask. Whoever
 * asks takes the touch that answers. */
void overlay_ask(struct overlay *overlay, int seconds_left);

/* A picture of the page that is open, over the whole panel, by its number on the page; the next one
 * slides in where one is shown already. -1 closes it, and so does whatever closes the page. */
void overlay_show_picture(struct overlay *overlay, int picture);
int overlay_picture(const struct overlay *overlay); /* or -1 */

/* The search, in the page's place: a field, parts that were found, a keyboard. It opens with
 * nothing typed and all parts listed, and closes card and page; without parts it does not open. */
void overlay_show_search(struct overlay *overlay, bool on);
/* Opens it as it was left. Say what is found, as of overlay_press. */
void overlay_search_again(struct overlay *overlay);
bool overlay_searching(const struct overlay *overlay);
/* What is typed; borrowed until the next overlay_press. */
const char *overlay_query(const struct overlay *overlay);
/* A key that OVERLAY_KEY named. true: what is typed changed; say what is found, unless it is
 * nothing, for then all parts are listed. */
bool overlay_press(struct overlay *overlay, int key);
/* Parts, best first, copied. */
void overlay_found(struct overlay *overlay, const uint32_t *parts, uint32_t count);

/* Guided tours, for the bar's menu, in the language that is set; copied. -1: no memory, or too
 * many: those before stay. What is shown of them closes where the count changes. */
struct overlay_tour {
	const char *title, *caption; /* caption may be "" */
	const char *thumbnail;       /* a picture's name, or "" */
};
must_check int overlay_tours(struct overlay *overlay, const struct overlay_tour *tours,
			     uint32_t count);
/* The menu; closes what is open. */
void overlay_show_tours(struct overlay *overlay, bool on);
bool overlay_choosing(const struct overlay *overlay);
/* All languages above the bar, over what is open, where the bar has one button for them; closes
 * when one is set. */
void overlay_show_languages(struct overlay *overlay, bool on);
bool overlay_choosing_language(const struct overlay *overlay);
/* The panel of the tour that is flown, while nothing else has its place; copied. NULL: none is. */
struct overlay_tour_state {
	int tour, stop, stop_count; /* stops are those at which it stays */
	const char *caption;
	bool paused;
};
void overlay_show_tour(struct overlay *overlay, const struct overlay_tour_state *state);

/* Ways of looking that the content gives visitors, a bit each: docs/tools.md. None at first. */
enum overlay_tool { OVERLAY_TOOL_LIGHT = 1, OVERLAY_TOOL_SECTION = 2 };
enum { OVERLAY_TOOL_COUNT = 2 };
void overlay_offer_tools(struct overlay *overlay, unsigned tools);
/* Those there is room for on the bar. */
unsigned overlay_tools_offered(const struct overlay *overlay);
/* Each frame. Directions are the disc's: its ring is at 1, up is away from who looks. */
struct overlay_tools {
	unsigned on;
	float light_at[2]; /* right, up */
	float turn_rad;    /* of what is cut away, from up to the left */
	float push;        /* of the section that way; 1 and -1 at the ring */
};
void overlay_show_tools(struct overlay *overlay, const struct overlay_tools *state);

/* A picture that was asked for is there now. */
void overlay_picture_arrived(struct overlay *overlay, const char *name);

/* Whether there is a way back, as the bar shows it. Not at first. */
void overlay_offer_back(struct overlay *overlay, bool on);

/* The part of the panel that is left for the model: all of it, or what a page leaves. Jumps when a
 * page opens; the app moves its camera there at its own pace. */
struct overlay_rect overlay_scene_rect(const struct overlay *overlay);

/* ---- touch ---- */

/* What a visitor chooses once and the next one does not find. */
struct overlay_comfort {
	bool large; /* type, THEME_LARGE_TYPE times as large */
	bool reach; /* all that can be touched is in the lower third, for who sits or is small */
};

/* Where the panel is so small that all of it is within reach, reach stays off. */
void overlay_set_comfort(struct overlay *overlay, struct overlay_comfort comfort);
struct overlay_comfort overlay_comfort(const struct overlay *overlay);

enum overlay_action_kind {
	OVERLAY_NONE,      /* nothing of ours is there: the tap is the model's */
	OVERLAY_SWALLOWED, /* ours, but nothing happens */
	OVERLAY_OPEN_CARD, /* part: a callout was tapped */
	OVERLAY_OPEN_PAGE, /* part: its card was tapped */
	OVERLAY_CLOSE_CARD,
	OVERLAY_CLOSE_PAGE,
	OVERLAY_WIDEN_PAGE, /* the page, which is wide or not (overlay_page_is_wide), changes over
			     */
	OVERLAY_LANGUAGE,   /* language */
	OVERLAY_LANGUAGES,  /* their menu, which is open or not (overlay_choosing_language), changes
			       over */
	OVERLAY_LINK,    /* link: what a page's link names, the id of a part or "tour:" and one's */
	OVERLAY_HOME,    /* to the first view */
	OVERLAY_BACK,    /* to where the visitor was, where that is offered */
	OVERLAY_HELP,    /* the help, which is there or not (overlay_help), changes over */
	OVERLAY_SEARCH,  /* the search, which is open or not (overlay_searching), changes over */
	OVERLAY_LARGE,   /* large type (overlay_comfort) changes over */
	OVERLAY_REACH,   /* so does reach */
	OVERLAY_LIGHT,   /* the tool, which is on or not, changes over */
	OVERLAY_SECTION, /* so does this one */
	OVERLAY_KEY,     /* key: for overlay_press */
	OVERLAY_FOUND,   /* part: one of those that were found */
	OVERLAY_PICTURE, /* picture: for overlay_show_picture */
	OVERLAY_TOURS,   /* the bar's: the menu, or the tour that is flown goes on */
	OVERLAY_TOUR,    /* tour: one was chosen */
	OVERLAY_TOUR_PAUSE, /* it halts, or goes on */
	OVERLAY_TOUR_CLOSE,
};

enum { OVERLAY_KEY_CLEAR = -1 }; /* the field's own: empties it */

struct overlay_action {
	enum overlay_action_kind kind;
	int part;             /* else -1 */
	int key;              /* of OVERLAY_KEY */
	int picture;          /* of OVERLAY_PICTURE */
	int tour;             /* of OVERLAY_TOUR */
	const char *language; /* borrowed until the overlay is destroyed; else NULL */
	const char *link;     /* borrowed until the page changes; else NULL */
};

/* What a tap there means. Changes nothing. */
struct overlay_action overlay_tap(const struct overlay *overlay, float x_px, float y_px);
/* A gesture that begins there is ours (it scrolls the page or is swallowed), not the model's. */
bool overlay_covers(const struct overlay *overlay, float x_px, float y_px);
/* A finger that comes down on one has it until it lifts. */
enum overlay_handle {
	OVERLAY_HANDLE_NONE,
	OVERLAY_HANDLE_LIGHT,
	OVERLAY_HANDLE_PUSH,
	OVERLAY_HANDLE_TURN,
};
enum overlay_handle overlay_handle_at(const struct overlay *overlay, float x_px, float y_px);
/* Where the finger is on its disc: right, up; also beyond the ring. */
void overlay_handle_place(const struct overlay *overlay, enum overlay_handle handle, float x_px,
			  float y_px, float at[2]);
/* Scrolls the page by a finger's movement; a fling goes on by itself. */
void overlay_scroll(struct overlay *overlay, float dy_px);
void overlay_fling(struct overlay *overlay, float vy_px_per_s);

/* Fingers on a picture that overlay_show_picture shows: one moves it when it is zoomed, else swipes
 * to the next; two zoom; two taps zoom in and out. */
void overlay_picture_drag(struct overlay *overlay, float dx_px, float dy_px);
void overlay_picture_drag_end(struct overlay *overlay, float vx_px_per_s);
void overlay_picture_pinch(struct overlay *overlay, float x_px, float y_px, float scale,
			   float dx_px, float dy_px);
void overlay_picture_double_tap(struct overlay *overlay, float x_px, float y_px);

/* ---- a frame ---- */

/* Advances fades and scrolling, lays out and draws what changed. true: something still moves, draw
 * again soon. */
bool overlay_update(struct overlay *overlay, int64_t now_ms);

/* A quad of a bitmap. The app keeps one texture per bitmap id and uploads the pixels when revision
 * is not the one it has. Draw in order, blending GL_ONE, GL_ONE_MINUS_SRC_ALPHA. */
struct overlay_layer {
	uint32_t bitmap;             /* id, below OVERLAY_BITMAPS_MAX */
	uint32_t revision;           /* never 0 */
	const struct bitmap *pixels; /* borrowed until the next overlay_update */
	float corners_px[4][2];      /* top left, top right, bottom right, bottom left */
	float source[4];             /* left, top, right, bottom of the bitmap, 0..1 */
	float alpha;                 /* multiplies all four channels */
};

/* At most `most` layers, bottom first; how many were written. */
uint32_t overlay_layers(const struct overlay *overlay, struct overlay_layer *layers, uint32_t most);

/* For headless pictures and tests: every layer drawn by Cairo over what context shows. */
void overlay_paint(const struct overlay *overlay, cairo_t *context);

#endif
