/* The tour that runs: its title, what is said at this stop, the stops, and the control that pauses.
 * It stands where a card would, while nothing else takes that place. */
#ifndef GOPURA_UI_TOUR_PLAYER_VIEW_H
#define GOPURA_UI_TOUR_PLAYER_VIEW_H

#include "ui/action.h"
#include "ui/fade.h"
#include "ui/layers.h"
#include "ui/overlay_data.h"
#include "ui/screen.h"

struct tour_player_view {
	struct fade fade; /* on: it is visible */
	bool runs;        /* a tour runs, whether it is visible or not */
	bool paused, dirty;
	int tour, stop, stop_count;
	char *caption; /* owned; NULL: none yet */
	struct sprite sprite;
};

void tour_player_view_init(struct tour_player_view *view, uint32_t *next_id);
void tour_player_view_finish(struct tour_player_view *view);

/* Sets the state; copied. NULL: no tour is running. Returns true if it comes or goes or has another
 * size now. */
bool tour_player_view_set(struct tour_player_view *view, const struct overlay_tour_state *state);
/* Removes it at once. */
void tour_player_view_drop(struct tour_player_view *view);

/* Returns its place. Its size is that of its last drawing. */
struct rect tour_player_view_rect(const struct tour_player_view *view, const struct screen *screen);
/* Returns what a tap on it means. */
struct overlay_action tour_player_view_tap(const struct tour_player_view *view,
					   const struct screen *screen, float x_px, float y_px);
/* Draws what changed and advances by step_ms. shows: a tour runs and its place is free. title is
 * the tour's, and is not read unless it shows. Returns true if something still moves. */
bool tour_player_view_update(struct tour_player_view *view, const struct screen *screen, bool shows,
			     const char *title, int64_t step_ms);
void tour_player_view_layers(const struct tour_player_view *view, const struct screen *screen,
			     struct layers *layers);

#endif
