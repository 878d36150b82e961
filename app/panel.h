/* The panel over the day: opening hours, waking it by touch, and the small picture shift against
 * burn-in. Also reports to the service manager that frames reach the panel. */
#ifndef GOPURA_APP_PANEL_H
#define GOPURA_APP_PANEL_H

#include "app/view/redraw.h"
#include "app/view/viewport.h"
#include "input/touch_event.h"
#include "render/display/display.h"
#include "system/hours.h"

struct panel_options {
	struct hours hours; /* opening hours, in which the panel is on */
	int wake_min;       /* minutes that a touch keeps it on outside them; 0: it does not */
	bool shift;         /* shift the picture by a pixel now and then */
	/* What it works with; borrowed. The picture's shift is set in the viewport. */
	struct display *display;
	struct viewport *viewport;
	struct redraw *redraw;
};

struct panel {
	struct panel_options options;
	int64_t well_ms;    /* time of the last frame reported to the service manager; 0: none */
	int64_t look_ms;    /* when to check the opening hours next; 0: at once */
	int64_t touched_ms; /* time of the last touch; 0: never */
	bool closed;        /* closed according to the opening hours at the last check */
	bool asleep;
	uint32_t taken; /* bit mask of contacts whose touch only wakes the panel */
};

/* Copies the options. */
void panel_init(struct panel *panel, const struct panel_options *options);
/* Called once per turn of the loop: opening hours, picture shift, service manager. frame_ms: when
 * the last frame was drawn; 0: none yet. Returns 0 or a negative errno of display_dispatch or
 * display_sleep. */
must_check int panel_turn(struct panel *panel, int64_t frame_ms);
/* Returns in how many milliseconds panel_turn has something to do; -1: only after an event. */
int panel_wait_ms(const struct panel *panel);
/* Handles a touch. Returns true if it wakes the panel, or belongs to a finger that did, and must
 * have no other effect. */
bool panel_take_touch(struct panel *panel, const struct touch_event *event);

#endif
