/* The panel over the day, as the kiosk's loop sees it: when it is on, where the picture lies on it,
 * whether there is anything to draw on, and what the service manager is told of it. */
#ifndef GOPURA_APP_PANEL_H
#define GOPURA_APP_PANEL_H

#include <stdbool.h>
#include <stdint.h>

#include "base/compiler.h"

struct kiosk;
struct touch_event;

struct panel {
	int64_t well_ms;    /* of the last frame that the service manager was told of; 0: of none */
	int64_t look_ms;    /* at the clock on the wall next; 0: at once */
	int64_t touched_ms; /* last; 0: never */
	bool closed;        /* by the hours, as last looked at */
	bool asleep;
	uint32_t taken;  /* contacts, a bit each, whose touch was for the panel alone */
	int shift_px[2]; /* of the picture: right and up */
};

/* Once a turn of the loop. Negative errno as of display_dispatch and display_sleep. */
must_check int panel_turn(struct kiosk *kiosk);
/* In how many milliseconds the next turn is due; -1: when something happens. */
int panel_wait_ms(const struct kiosk *kiosk);
/* A finger on the glass. true: it wakes the panel, or did, and means nothing else. */
bool panel_takes_touch(struct kiosk *kiosk, const struct touch_event *event);

#endif
