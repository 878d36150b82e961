/* The menu of languages, used if the bar has one button for all of them. It stands above the bar
 * and over whatever is open, so that switching the language does not close the page. */
#ifndef GOPURA_UI_LANGUAGES_VIEW_H
#define GOPURA_UI_LANGUAGES_VIEW_H

#include "ui/action.h"
#include "ui/fade.h"
#include "ui/languages.h"
#include "ui/layers.h"
#include "ui/screen.h"

struct languages_view {
	struct fade fade; /* on: it is open */
	bool dirty;       /* texts or sizes changed: draw it again when it is open */
	struct sprite sprite;
};

void languages_view_init(struct languages_view *view, uint32_t *next_id);
void languages_view_finish(struct languages_view *view);

/* Opens or closes the menu. Returns true if that changes anything. */
bool languages_view_show(struct languages_view *view, bool on);
/* Returns its place, whether it is open or not. */
struct rect languages_view_rect(const struct screen *screen, const struct languages *languages);
/* Returns what a tap means while the menu is open; beside the menu, a tap closes it. */
struct overlay_action languages_view_tap(const struct screen *screen,
					 const struct languages *languages, float x_px, float y_px);
/* Draws what changed and advances by step_ms. Returns true if something still moves. */
bool languages_view_update(struct languages_view *view, const struct screen *screen,
			   const struct languages *languages, int64_t step_ms);
void languages_view_layers(const struct languages_view *view, const struct screen *screen,
			   const struct languages *languages, struct layers *layers);

#endif
