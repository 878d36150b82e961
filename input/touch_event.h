/* An event of a finger on the panel. */
#ifndef GOPURA_INPUT_TOUCH_EVENT_H
#define GOPURA_INPUT_TOUCH_EVENT_H

#include <stdint.h>

enum { TOUCH_CONTACTS_MAX = 10 };

enum touch_phase {
	TOUCH_DOWN,
	TOUCH_MOVE,
	TOUCH_UP,
	TOUCH_CANCEL, /* the contact ends without being meant: a palm, or the device went away */
};

struct touch_event {
	enum touch_phase phase;
	uint32_t contact; /* 0 .. TOUCH_CONTACTS_MAX-1; unique among the fingers that are down */
	float x_px, y_px; /* of the picture as the visitor sees it: x right, y down */
	int64_t time_us;  /* time of the kernel's event (CLOCK_MONOTONIC); a replay starts at 0 */
};

#endif
