/* The panel over the day, as the kiosk's loop sees it: whether there is anything to draw on, and
 * what the service manager is told of it. */
#ifndef GOPURA_APP_PANEL_H
#define GOPURA_APP_PANEL_H

#include "base/compiler.h"

struct kiosk;

/* Once a turn of the loop. Negative errno as of display_dispatch. */
must_check int panel_turn(struct kiosk *kiosk);
/* In how many milliseconds the next turn is due; -1: when something happens. */
int panel_wait_ms(const struct kiosk *kiosk);

#endif
