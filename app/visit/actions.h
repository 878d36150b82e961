/* What a visitor's taps do: on the overlay they open, close, search and lead elsewhere; on the
 * model they show parts. Also starts the flights of the eye that they ask for. */
#ifndef GOPURA_APP_VISIT_ACTIONS_H
#define GOPURA_APP_VISIT_ACTIONS_H

#include "app/visit/back.h"
#include "app/visit/counting.h"
#include "app/visit/listening.h"
#include "app/visit/tools.h"
#include "app/visit/tour_player.h"

/* What the actions work with; all of it is borrowed. They keep no state of their own. */
struct actions {
	const struct exhibit *shown;
	struct eye *eye;
	const struct viewport *viewport;
	struct tour_player *tours;
	struct tools *tools;
	struct back *back;
	struct counting *counting;
	struct listening *listening;
};

/* All functions need an overlay. Positions are in the visitor's pixels. */
/* Carries out what a tap on the overlay means. */
void actions_carry_out(const struct actions *actions, const struct overlay_action *action);
/* Shows the card of the part that was tapped on the model, or closes the card. Scenery that a touch
 * moves begins to move instead. */
void actions_show_part_at(const struct actions *actions, float x_px, float y_px);
/* Opens the page of the part that was double-tapped on the model, if there is one. */
void actions_open_part_at(const struct actions *actions, float x_px, float y_px);
/* Presses a key of the on-screen keyboard. */
void actions_press_key(const struct actions *actions, int key);

#endif
