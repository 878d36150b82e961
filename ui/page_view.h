/* The page of a part beside the model, or over the whole panel. It owns the article and draws it in
 * strips, so that a long page needs no long bitmap. */
#ifndef GOPURA_UI_PAGE_VIEW_H
#define GOPURA_UI_PAGE_VIEW_H

#include "ui/action.h"
#include "ui/article_layout.h"
#include "ui/fade.h"
#include "ui/layers.h"
#include "ui/paper.h"
#include "ui/screen.h"
#include "ui/scroll.h"
#include "ui/spoken_view.h"

enum { PAGE_STRIPS = 16 };

struct page_view_strip {
	int index;  /* number of the piece of the article, or -1 */
	bool stale; /* the article changed there: redraw; the old drawing shows until then */
	struct fade fade;
	struct sprite sprite;
};

struct page_view {
	struct article_layout *article; /* owned; NULL when no page is open or fading out */
	struct fade fade;
	int part;        /* -1 when closed */
	bool wide;       /* over the whole panel; also while fading out */
	bool head_dirty; /* title, texts or sizes changed: draw the head again */
	int strip_px;
	struct page_view_strip strips[PAGE_STRIPS];
	struct scroll scroll;
	struct sprite head, foot; /* foot: text fades out if there is more below */
	bool is_spoken;           /* the page has a spoken text, which can be heard */
	struct spoken_view spoken;
};

/* height_px is the panel's. */
void page_view_init(struct page_view *view, const struct theme *theme, int height_px,
		    uint32_t *next_id);
void page_view_finish(struct page_view *view);

/* Opens the page of a part, or replaces the open page. bytes is an encoded article
 * (format/article.h). Returns the errors of article_create; then nothing changes. */
must_check int page_view_open(struct page_view *view, const struct screen *screen, int part,
			      struct bytes bytes, const char *credits,
			      const struct picture_source *pictures);
/* The page fades out. */
void page_view_close(struct page_view *view);
/* Removes the page at once. */
void page_view_drop(struct page_view *view);
/* Gives it the whole panel, or puts it back beside the model; in reach mode it stays there. Returns
 * true if that changes anything. */
bool page_view_widen(struct page_view *view, const struct screen *screen, bool on);
/* The screen or the size of type changed: lays the page out again. The first visible line stays
 * about the same. */
void page_view_lay_out(struct page_view *view, const struct screen *screen);
/* A picture arrived: draws the strips again from there on. */
void page_view_picture_arrived(struct page_view *view, const char *name);

/* Whether the page has a spoken text that can be heard. */
void page_view_offer_spoken(struct page_view *view, bool offered);
/* Shows what is spoken now; copied. NULL: nothing. */
void page_view_show_spoken(struct page_view *view, const struct overlay_spoken *spoken);

/* The share of the page that is above the visible part, 0..1; 0 without a page. */
float page_view_read(const struct page_view *view);
/* Scrolls to such a share. */
void page_view_read_from(struct page_view *view, const struct screen *screen, float share);
/* Returns the largest scroll position; 0 without a page. */
int page_view_scroll_most(const struct page_view *view, const struct screen *screen);

/* These places do not depend on the screen's scene. */
struct rect page_view_rect(const struct page_view *view, const struct screen *screen);
/* The visible window on the article: below the head, above the bar. */
struct rect page_view_window(const struct page_view *view, const struct screen *screen);
struct rect page_view_close_button(const struct page_view *view, const struct screen *screen);
/* Beside the close control; empty if the page cannot be widened. */
struct rect page_view_widen_button(const struct page_view *view, const struct screen *screen);
/* Beside these; empty if the page has no spoken text. */
struct rect page_view_listen_button(const struct page_view *view, const struct screen *screen);
/* Returns what a tap on the open page means. */
struct overlay_action page_view_tap(const struct page_view *view, const struct screen *screen,
				    float x_px, float y_px);

/* Draws what changed and advances by step_ms. title is the part's, and is
 * not read when the page is closed. Returns true if something still
 * moves. Once it has faded out, its article is NULL. */
bool page_view_update(struct page_view *view, const struct screen *screen, const char *title,
		      int64_t step_ms);
void page_view_layers(const struct page_view *view, const struct screen *screen,
		      const struct paper *paper, struct layers *layers);

#endif
