/* The card of a part: thumbnail, title, caption and a hint that there is more to read. The whole
 * card is one touch target, except for the corner that closes it. */
#ifndef GOPURA_UI_CARD_VIEW_H
#define GOPURA_UI_CARD_VIEW_H

#include "ui/action.h"
#include "ui/fade.h"
#include "ui/layers.h"
#include "ui/parts.h"
#include "ui/screen.h"
#include "ui/source.h"

struct card_view {
	struct fade fade;
	int part, shown; /* part: -1 when closed; shown: on its bitmap, also while fading out */
	bool dirty;      /* texts, sizes or the thumbnail changed: draw it again when it is open */
	struct sprite sprite;
};

void card_view_init(struct card_view *view, uint32_t *next_id);
void card_view_finish(struct card_view *view);

/* Opens the card of a part; -1 closes it. Returns true if that changes anything. */
bool card_view_show(struct card_view *view, int part);
/* Removes it at once. */
void card_view_drop(struct card_view *view);

/* Returns its place, whether it is open or not. A shadow runs around the card inside of it. */
struct rect card_view_rect(const struct screen *screen);
/* Returns what a tap on the open card means. */
struct overlay_action card_view_tap(const struct card_view *view, const struct screen *screen,
				    const struct parts *parts, float x_px, float y_px);
/* Draws what changed and advances by step_ms. Returns true if something still moves. */
bool card_view_update(struct card_view *view, const struct screen *screen,
		      const struct parts *parts, const struct picture_source *pictures,
		      int64_t step_ms);
void card_view_layers(const struct card_view *view, const struct screen *screen,
		      struct layers *layers);

#endif
