/* The layout of the panel that the views share: its size, the look, where the bar is and what is
 * left for the model. It is made anew for each call into a view, so it is never out of date. */
#ifndef GOPURA_UI_SCREEN_H
#define GOPURA_UI_SCREEN_H

#include "ui/rect.h"
#include "ui/theme.h"

struct screen {
	const struct theme *theme; /* borrowed */
	int width_px, height_px;   /* of the panel */
	bool reach;                /* all controls are in the lower third */
	struct rect bar;           /* the bar of controls, at the lower left */
	struct rect scene;         /* what page or search leave for the model */
};

int screen_px(const struct screen *screen, float mm);      /* as theme_px */
int screen_text_px(const struct screen *screen, float mm); /* as theme_text_px */

bool screen_is_portrait(const struct screen *screen);
/* Returns true if the panel is large enough for reach mode. */
bool screen_offers_reach(const struct screen *screen);
/* In reach mode, the line below which all controls are; else 0. */
int screen_reach_top(const struct screen *screen);
/* Reach mode on a wide panel: page and search lie flat, with their head beside the bar. */
bool screen_is_flat(const struct screen *screen);
/* The place of a page or the search beside the model. */
struct rect screen_half(const struct screen *screen);

/* Returns the lowest line that the scene may use: above the bar if the bar is in the scene. In
 * reach mode it is always above the bar; a card then lies over a page, not above it. */
int screen_floor(const struct screen *screen);
/* A rectangle of that size, centred in the scene, on that line. */
struct rect screen_above_floor(const struct screen *screen, int width_px, int height_px);

#endif
