/* The search: a field, a list of results and a keyboard. It stands where a page would. If half a
 * panel is too narrow for fingers on keys, it takes the whole width. */
#ifndef GOPURA_UI_SEARCH_VIEW_H
#define GOPURA_UI_SEARCH_VIEW_H

#include "ui/action.h"
#include "ui/fade.h"
#include "ui/keyboard.h"
#include "ui/layers.h"
#include "ui/paper.h"
#include "ui/parts.h"
#include "ui/screen.h"
#include "ui/scroll.h"
#include "ui/source.h"

enum { SEARCH_ROWS = 16, SEARCH_QUERY_BYTES = 128 };

struct search_view_row {
	int part, index; /* the part and the row drawn on it; part -1: nothing yet */
	bool stale;
	struct fade fade;
	struct sprite sprite;
};

struct search_view {
	struct fade fade; /* on: it is open */
	char query[SEARCH_QUERY_BYTES];
	struct keyboard keyboard;
	int pressed; /* the last pressed key, or -1 */
	struct fade press;
	uint32_t *found; /* owned; room for every part */
	uint32_t found_count, found_room, part_count;
	struct search_view_row rows[SEARCH_ROWS];
	struct scroll scroll;
	bool head_dirty, keyboard_dirty;
	struct sprite head, keys, key; /* key: highlight over the key that was pressed */
};

void search_view_init(struct search_view *view, uint32_t *next_id);
void search_view_finish(struct search_view *view);

/* Makes room for that many results, and changes nothing else. Returns -ENOMEM. */
must_check int search_view_reserve(struct search_view *view, uint32_t part_count);
/* There is room for part_count parts, and this is their number now. If it is another one, nothing
 * is found and the search closes at once. */
void search_view_set_count(struct search_view *view, uint32_t part_count);
/* Texts or sizes changed: draws all of it again. */
void search_view_redraw(struct search_view *view, const struct screen *screen);
/* A picture arrived: draws the rows again that show it. */
void search_view_picture_arrived(struct search_view *view, const struct parts *parts,
				 const char *name);

/* Opens it with a query, and lists all parts. */
void search_view_open(struct search_view *view, const struct screen *screen, const char *query);
void search_view_close(struct search_view *view);
/* Presses the key of an OVERLAY_KEY action. Returns true if the query changed. If it is empty then,
 * all parts are listed. */
bool search_view_press(struct search_view *view, const struct screen *screen, int key);
/* Sets the parts that were found, best first; copied. */
void search_view_set_found(struct search_view *view, const uint32_t *parts, uint32_t count);

/* The places of all of the paper, of the keyboard and of the list. They do not depend on the
 * screen's scene. */
struct rect search_view_rect(const struct screen *screen);
struct rect search_view_keyboard(const struct search_view *view, const struct screen *screen);
struct rect search_view_list(const struct search_view *view, const struct screen *screen);
/* Returns the height of a row of the list. */
int search_view_row_px(const struct search_view *view, const struct screen *screen);
/* Returns the largest scroll position of the list. */
int search_view_scroll_most(const struct search_view *view, const struct screen *screen);
/* Returns what a tap on it means. */
struct overlay_action search_view_tap(const struct search_view *view, const struct screen *screen,
				      float x_px, float y_px);
/* Draws what changed and advances by step_ms. Returns true if something still moves. */
bool search_view_update(struct search_view *view, const struct screen *screen,
			const struct parts *parts, const struct picture_source *pictures,
			int64_t step_ms);
void search_view_layers(const struct search_view *view, const struct screen *screen,
			const struct paper *paper, struct layers *layers);

#endif
