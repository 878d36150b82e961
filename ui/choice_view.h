/* A row of a few words of which one is chosen: the states in which the site can be seen. It stands
 * at the right end of the bar's line, or at the top of the scene if there is no room beside the
 * bar, and shows unless something open covers its place. */
#ifndef GOPURA_UI_CHOICE_VIEW_H
#define GOPURA_UI_CHOICE_VIEW_H

#include "ui/action.h"
#include "ui/fade.h"
#include "ui/layers.h"
#include "ui/overlay_data.h"
#include "ui/screen.h"
#include "ui/tools_view.h"

struct choice_view {
	char titles[OVERLAY_CHOICES_MAX][OVERLAY_CHOICE_BYTES];
	uint32_t count; /* fewer than two: there is nothing to choose */
	uint32_t chosen;
	int wanted_px[OVERLAY_CHOICES_MAX]; /* widths for whole titles; of the last update */
	struct fade fade;                   /* on: it is visible */
	struct rect drawn;                  /* for which it was drawn */
	bool dirty;                         /* titles, choice or size of type changed */
	struct sprite sprite;
};

void choice_view_init(struct choice_view *view, uint32_t *next_id);
void choice_view_finish(struct choice_view *view);

/* Sets the titles, copied; at most OVERLAY_CHOICES_MAX are taken. */
void choice_view_set(struct choice_view *view, const char *const *titles, uint32_t count,
		     uint32_t chosen);
/* Returns its place, whether it shows or not. */
struct rect choice_view_rect(const struct choice_view *view, const struct screen *screen);
/* Returns true if there is something to choose and its place is free. */
bool choice_view_shows(const struct choice_view *view, const struct screen *screen,
		       const struct tools_view_obstacles *obstacles);
/* Returns what a tap on its place means. */
struct overlay_action choice_view_tap(const struct choice_view *view, const struct screen *screen,
				      float x_px);
/* Draws what changed and advances by step_ms. Returns true if something still moves. */
bool choice_view_update(struct choice_view *view, const struct screen *screen,
			const struct tools_view_obstacles *obstacles, int64_t step_ms);
void choice_view_layers(const struct choice_view *view, struct layers *layers);

#endif
