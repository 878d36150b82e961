/* The menu of guided tours. It stands where a card would. */
#ifndef GOPURA_UI_TOURS_VIEW_H
#define GOPURA_UI_TOURS_VIEW_H

#include "ui/action.h"
#include "ui/fade.h"
#include "ui/layers.h"
#include "ui/overlay_data.h"
#include "ui/screen.h"
#include "ui/source.h"

struct tours_view {
	struct fade fade;                            /* on: it is open */
	struct overlay_tour list[OVERLAY_TOURS_MAX]; /* its texts are owned */
	uint32_t count;
	bool dirty; /* texts or sizes changed: draw it again when it is open */
	struct sprite sprite;
};

void tours_view_init(struct tours_view *view, uint32_t *next_id);
void tours_view_finish(struct tours_view *view);

/* Sets the tours; copied. The menu closes if the count changes. Returns -1 if memory runs out or
 * there are more than OVERLAY_TOURS_MAX; then nothing changes. */
must_check int tours_view_set(struct tours_view *view, const struct overlay_tour *tours,
			      uint32_t count);
/* Opens or closes the menu; without tours it does not open. Returns true if that changes
 * anything. */
bool tours_view_show(struct tours_view *view, bool on);
/* A picture arrived: draws the menu again if it shows it. */
void tours_view_picture_arrived(struct tours_view *view, const char *name);

struct rect tours_view_rect(const struct tours_view *view, const struct screen *screen);
/* Returns what a tap on the menu means. */
struct overlay_action tours_view_tap(const struct tours_view *view, const struct screen *screen,
				     float x_px, float y_px);
/* Draws what changed and advances by step_ms. Returns true if something still moves. */
bool tours_view_update(struct tours_view *view, const struct screen *screen,
		       const struct picture_source *pictures, int64_t step_ms);
void tours_view_layers(const struct tours_view *view, const struct screen *screen,
		       struct layers *layers);

#endif
