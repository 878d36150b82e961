/* Everything that is drawn over the model: callouts, the card, the page beside the model and its
 * pictures, search, tours, tools, the language switch, home and help. The overlay owns what is
 * shown, draws it with Pango and Cairo into bitmaps, and gives the app a list of textured quads. It
 * knows no GL, no network and no database. The app gives it texts, pictures and the positions of
 * anchors; a tap is answered by an action that the app carries out.
 *
 * A frame: overlay_anchors (if the camera moved) -> overlay_update -> overlay_layers. One thread.
 * Pixels are those of the picture as the visitor sees it: x right, y down. */
#ifndef GOPURA_UI_OVERLAY_H
#define GOPURA_UI_OVERLAY_H

#include <stdbool.h>
#include <stdint.h>

#include "base/bytes.h"
#include "ui/action.h"
#include "ui/layers.h"
#include "ui/overlay_data.h"
#include "ui/rect.h"
#include "ui/source.h"

enum {
	OVERLAY_LAYERS_MAX = 256,  /* in one frame */
	OVERLAY_BITMAPS_MAX = 136, /* bitmap ids are below this */
};

struct overlay_options {
	int width_px, height_px; /* size of the panel; 320 .. 8192 */
	float px_per_mm;         /* of the panel; 0: guessed from its size */
	const char *const
		*languages; /* languages of the release, copied; the first is the default */
	uint32_t language_count;
	/* Returns a picture by the name that a page or thumbnail gives ("pictures/gate.jpg").
	 * false: no picture has that name. Asking also requests it: the app fetches it and then
	 * calls overlay_picture_arrived. NULL: no pictures. */
	bool (*picture)(void *data, const char *name, struct found_picture *out);
	void *data;
};

struct overlay;

/* *out is owned by the caller; on failure it is NULL. Returns -EINVAL for a size or a number of
 * languages out of range, or -ENOMEM. */
must_check int overlay_create(struct overlay **out, const struct overlay_options *options);
void overlay_destroy(struct overlay *overlay); /* NULL is fine */

/* ---- content ---- */

/* Sets the parts, in order of importance, in the current language; copied. Card, page and search
 * are closed if the count changes. Returns -EINVAL for more than OVERLAY_PARTS_MAX, or -ENOMEM;
 * then nothing changes. */
must_check int overlay_parts(struct overlay *overlay, const struct overlay_part *parts,
			     uint32_t count);
/* Sets the language of the overlay's own texts. The caller then passes the parts (and the page, if
 * one is open) again in that language. */
void overlay_language(struct overlay *overlay, const char *language);

/* Copies the anchors, one per part. Extra entries are ignored. */
void overlay_anchors(struct overlay *overlay, const struct overlay_anchor *anchors, uint32_t count);

/* Opens the card of a part; -1 closes it. */
void overlay_show_card(struct overlay *overlay, int part);
int overlay_card(const struct overlay *overlay); /* the part whose card is open, or -1 */

/* Opens the page of a part beside the model, or replaces the open page. article is encoded
 * (format/article.h); it is decoded now and not kept. credits is small print below the page, in one
 * line; it is copied and may be "". Returns -EBADMSG if article is not valid, -EINVAL if there is
 * no such part, or -ENOMEM. */
must_check int overlay_show_page(struct overlay *overlay, int part, struct bytes article,
				 const char *credits);
/* Closes the page and its pictures. The page fades out. */
void overlay_close_page(struct overlay *overlay);
int overlay_page(const struct overlay *overlay); /* the part whose page is open, or -1 */

/* Switches the page between the whole panel and its place beside the model. A card or reach mode
 * puts it back beside the model. The next page that is opened stands beside it again. */
void overlay_widen_page(struct overlay *overlay, bool on);
/* Returns true if the page has the whole panel. */
bool overlay_page_is_wide(const struct overlay *overlay);

/* The scroll position: the share of the page that is above the visible part, 0..1; 0 without a
 * page. */
float overlay_read(const struct overlay *overlay);
/* Scrolls to such a share. */
void overlay_read_from(struct overlay *overlay, float share);

/* Offers the spoken text of the open page with a button in its head; not offered when a page is
 * opened. */
void overlay_offer_spoken(struct overlay *overlay, bool offered);
/* Shows that it is spoken, and which words; copied. NULL: it is not. A page that closes ends it. */
void overlay_show_spoken(struct overlay *overlay, const struct overlay_spoken *spoken);

/* The help: how to touch the model, in pictures and words. It is on at first; the app turns it off
 * at the first touch. */
void overlay_show_help(struct overlay *overlay, bool on);
/* Returns true if the help is on. */
bool overlay_help(const struct overlay *overlay);

/* The invitation to touch, in every language, for when no visitor is present. It stands where the
 * help stands; the help comes when the invitation goes. Off at first. */
void overlay_invite(struct overlay *overlay, bool on);
/* Asks over everything else whether the visitor is still there, and shows the seconds left; -1:
 * does not ask. The caller handles the touch that answers. */
void overlay_ask(struct overlay *overlay, int seconds_left);

/* Shows a picture of the open page over the whole panel, by its number on the page. If one is shown
 * already, the new one slides in. -1 closes it; so does everything that closes the page. */
void overlay_show_picture(struct overlay *overlay, int picture);
int overlay_picture(
	const struct overlay *overlay); /* the number of the picture that is shown, or -1 */

/* The search, in the page's place: a field, the parts that were found, a keyboard. It opens with an
 * empty field and lists all parts; it closes card and page. Without parts it does not open. */
void overlay_show_search(struct overlay *overlay, bool on);
/* Opens the search with a query that was typed before; copied. The caller must then call
 * overlay_found, as after overlay_press. */
void overlay_search_again(struct overlay *overlay, const char *query);
/* Returns true if the search is open. */
bool overlay_searching(const struct overlay *overlay);
/* Returns the query; borrowed until the next overlay_press. */
const char *overlay_query(const struct overlay *overlay);
/* Presses the key of an OVERLAY_KEY action. Returns true if the query changed. The caller then
 * calls overlay_found, unless the query is empty: then all parts are listed. */
bool overlay_press(struct overlay *overlay, int key);
/* Sets the parts that were found, best first; copied. */
void overlay_found(struct overlay *overlay, const uint32_t *parts, uint32_t count);

/* Sets the guided tours of the menu, in the current language; copied. Returns -1 if memory runs out
 * or there are more than OVERLAY_TOURS_MAX; then nothing changes. Menu and tour close if the
 * count changes. */
must_check int overlay_tours(struct overlay *overlay, const struct overlay_tour *tours,
			     uint32_t count);
/* Opens or closes the menu of tours; opening closes what else is open. */
void overlay_show_tours(struct overlay *overlay, bool on);
/* Returns true if the menu of tours is open. */
bool overlay_choosing(const struct overlay *overlay);
/* Opens or closes the menu of all languages. It exists only if the bar has one button for all of
 * them. It stands above the bar, over whatever is open, and closes when a language is set. */
void overlay_show_languages(struct overlay *overlay, bool on);
/* Returns true if the menu of languages is open. */
bool overlay_choosing_language(const struct overlay *overlay);
/* Shows the tour that runs, while nothing else takes its place. The state is copied; NULL: no tour
 * is running. */
void overlay_show_tour(struct overlay *overlay, const struct overlay_tour_state *state);

/* Sets which tools the bar offers, none at first: a mask of enum overlay_tool. */
void overlay_offer_tools(struct overlay *overlay, unsigned tools);
/* Returns the offered tools that fit on the bar. */
unsigned overlay_tools_offered(const struct overlay *overlay);
/* Sets the state of the tools, each frame; copied. */
void overlay_show_tools(struct overlay *overlay, const struct overlay_tools *state);

/* Sets the states of the site that can be chosen, in the current language, and which one is;
 * copied, and may be the same in each frame. Fewer than two: there is nothing to choose. */
void overlay_show_choice(struct overlay *overlay, const char *const *titles, uint32_t count,
			 uint32_t chosen);

/* Tells that a picture that was asked for has arrived. */
void overlay_picture_arrived(struct overlay *overlay, const char *name);

/* Sets whether the bar's back button is active. Not at first. */
void overlay_offer_back(struct overlay *overlay, bool on);

/* Returns the part of the panel that is left for the model: all of it, or what page or search
 * leave. It changes at once when a page opens; the app moves its camera there at its own pace. */
struct rect overlay_scene_rect(const struct overlay *overlay);

/* ---- touch ---- */

/* Sets large type and reach mode. Reach stays off on a panel that is too small for it. */
void overlay_set_comfort(struct overlay *overlay, struct overlay_comfort comfort);
/* Returns the current settings. */
struct overlay_comfort overlay_comfort(const struct overlay *overlay);

/* Returns what a tap at that point means. Changes nothing. */
struct overlay_action overlay_tap(const struct overlay *overlay, float x_px, float y_px);
/* Returns true if a gesture that begins at that point belongs to the overlay (it scrolls the page
 * or is ignored), not to the model. */
bool overlay_covers(const struct overlay *overlay, float x_px, float y_px);
/* Returns the handle at that point, or OVERLAY_HANDLE_NONE. */
enum overlay_handle overlay_handle_at(const struct overlay *overlay, float x_px, float y_px);
/* Converts a finger's position to the coordinates of the handle's disc: right, up; the ring is at
 * 1, and the finger may be beyond it. */
void overlay_handle_place(const struct overlay *overlay, enum overlay_handle handle, float x_px,
			  float y_px, float at[2]);
/* Scrolls the page or the search results by a finger's movement. After a fling, scrolling goes on
 * by itself. */
void overlay_scroll(struct overlay *overlay, float dy_px);
/* Starts such a fling. */
void overlay_fling(struct overlay *overlay, float vy_px_per_s);

/* Gestures on a picture that overlay_show_picture shows. One finger moves a zoomed picture, else it
 * swipes to the next. Two fingers zoom; a double tap zooms in and out. */
void overlay_picture_drag(struct overlay *overlay, float dx_px, float dy_px);
/* Ends a drag with the finger's speed: a flick, or a drag past a quarter of the panel, swipes
 * on. */
void overlay_picture_drag_end(struct overlay *overlay, float vx_px_per_s);
/* scale is relative to the last call; the point x_px, y_px stays under the fingers. */
void overlay_picture_pinch(struct overlay *overlay, float x_px, float y_px, float scale,
			   float dx_px, float dy_px);
/* Zooms in at that point, or out again. */
void overlay_picture_double_tap(struct overlay *overlay, float x_px, float y_px);

/* ---- a frame ---- */

/* Advances fades and scrolling, lays out and draws what changed. now_ms is monotonic. Returns true
 * if something still moves: draw again soon. */
bool overlay_update(struct overlay *overlay, int64_t now_ms);

/* Writes at most `most` layers, bottom first. Returns how many were written. */
uint32_t overlay_layers(const struct overlay *overlay, struct overlay_layer *layers, uint32_t most);

/* For headless pictures and tests: draws every layer with Cairo over the contents of context. */
void overlay_paint(const struct overlay *overlay, cairo_t *context);

#endif
