/* Plays guided tours: starts and halts them, flies the eye to their path, and shows captions in the
 * overlay. See docs/tours.md. */
#ifndef GOPURA_APP_VISIT_TOUR_PLAYER_H
#define GOPURA_APP_VISIT_TOUR_PLAYER_H

#include "app/view/eye.h"
#include "app/view/redraw.h"
#include "app/visit/counting.h"
#include "app/visit/tour.h"

/* What the player works with; borrowed. */
struct tour_player_env {
	const struct exhibit *shown;
	struct eye *eye;
	struct counting *counting;
	struct redraw *redraw;
};

struct tour_player {
	struct tour_player_env env;
	struct tour tour; /* of a visitor, or the looping one while nobody is there */
};

void tour_player_init(struct tour_player *player, const struct tour_player_env *env);
/* Starts a tour for a visitor. which: its index; -1: does nothing. Needs an overlay. */
void tour_player_start(struct tour_player *player, int which);
/* Halts a visitor's tour; ends the looping tour that runs while nobody is there. */
void tour_player_halt(struct tour_player *player);
/* Ends the tour, if there is one. */
void tour_player_end(struct tour_player *player);
/* The tour button of the bar: halts or continues a tour, starts it if the release has exactly one,
 * or opens or closes the choice of tours. Needs an overlay. */
void tour_player_press(struct tour_player *player);
/* Starts the looping tour for the time while nobody is there. Returns false if the release has
 * none. */
bool tour_player_start_loop(struct tour_player *player);
/* Returns whether a visitor is on a tour, running or halted. */
bool tour_player_has_visitor(const struct tour_player *player);
/* Moves the eye along the tour, if one is running; nobody: no visitor is there. Returns true if it
 * keeps moving. */
bool tour_player_lead_eye(struct tour_player *player, int64_t now_ms, bool nobody);
/* Tells the overlay the tour's state: caption, stop, paused. */
void tour_player_show(struct tour_player *player);
/* Returns the part to highlight at the current stop, or -1. */
int tour_player_part(const struct tour_player *player);
/* Another release is shown, which has other tours: ends the tour. data is the player. */
void tour_player_on_release(void *data, const struct exhibit_change *change);

#endif
