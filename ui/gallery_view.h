/* The pictures of the open page, one at a time over the whole panel. Two fingers zoom. One finger
 * moves a zoomed picture, else it swipes to the next. The bar stays visible over it. */
#ifndef GOPURA_UI_GALLERY_VIEW_H
#define GOPURA_UI_GALLERY_VIEW_H

#include "ui/action.h"
#include "ui/article_layout.h"
#include "ui/fade.h"
#include "ui/layers.h"
#include "ui/screen.h"
#include "ui/source.h"

enum gallery_view_button { GALLERY_CLOSE, GALLERY_BACK, GALLERY_ON, GALLERY_BUTTONS };
enum { GALLERY_SLOTS = 3 }; /* the current picture and its neighbours */

struct gallery_view_slot {
	int picture; /* the picture drawn or requested; -1: none */
	struct fade fade;
	struct sprite sprite;
};

struct gallery_view {
	struct fade fade; /* on: it is open */
	int at, count;    /* the number of the picture on the page, and how many the page has */
	float zoom, x_px, y_px; /* zoom 1: it fits; x_px, y_px: its centre relative to the view's */
	float swipe_px;         /* offset of a swipe to the next picture, or back */
	bool dragging, words_dirty;
	struct gallery_view_slot slots[GALLERY_SLOTS]; /* picture % GALLERY_SLOTS */
	struct sprite night, words, buttons[GALLERY_BUTTONS];
};

/* Draws what never changes. */
void gallery_view_init(struct gallery_view *view, const struct theme *theme, uint32_t *next_id);
void gallery_view_finish(struct gallery_view *view);

/* Shows a picture, one of count. If one is shown already, the new one slides in. -1 closes. */
void gallery_view_show(struct gallery_view *view, const struct screen *screen, int picture,
		       int count);
/* The page is gone: closes at once and forgets its pictures. */
void gallery_view_drop(struct gallery_view *view);
/* A picture of the page arrived: draws it again if it is shown. */
void gallery_view_picture_arrived(struct gallery_view *view, const struct article_layout *article,
				  const char *name);

/* Gestures, as in ui/overlay.h. */
void gallery_view_drag(struct gallery_view *view, const struct screen *screen, float dx_px,
		       float dy_px);
void gallery_view_drag_end(struct gallery_view *view, const struct screen *screen,
			   float vx_px_per_s);
void gallery_view_pinch(struct gallery_view *view, const struct screen *screen, float x_px,
			float y_px, float scale, float dx_px, float dy_px);
void gallery_view_double_tap(struct gallery_view *view, const struct screen *screen, float x_px,
			     float y_px);

/* The place of a picture that is not zoomed: above its caption, which is above the bar. */
struct rect gallery_view_rect(const struct screen *screen);
struct rect gallery_view_button(const struct screen *screen, enum gallery_view_button button);
/* Sets left, top, width and height of a picture. Returns false if it is not drawn yet. */
bool gallery_view_place(const struct gallery_view *view, const struct screen *screen, int picture,
			float place_px[4]);
/* Returns what a tap means while it is open. */
struct overlay_action gallery_view_tap(const struct gallery_view *view, const struct screen *screen,
				       float x_px, float y_px);
/* Draws what changed and advances by step_ms. article is the open page's, NULL: none. Returns true
 * if something still moves. */
bool gallery_view_update(struct gallery_view *view, const struct screen *screen,
			 const struct article_layout *article,
			 const struct picture_source *pictures, int64_t step_ms);
void gallery_view_layers(const struct gallery_view *view, const struct screen *screen,
			 struct layers *layers);

#endif
