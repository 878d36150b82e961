/* Recognises gestures from touch events. Pure: no clock and no device. All times are those of the
 * events, so a scripted or replayed sequence gives the same gestures on any machine.
 *
 * A tap is reported at once when the finger lifts. When a second one follows soon and near,
 * GESTURE_DOUBLE_TAP is reported for the second instead. So the first tap never waits, and a caller
 * whose double tap only goes further than its tap (card, then page) needs no timer. */
#ifndef GOPURA_INPUT_GESTURE_H
#define GOPURA_INPUT_GESTURE_H

#include <stdbool.h>

#include "input/touch_event.h"

enum gesture_kind {
	GESTURE_PRESS,       /* the first finger came down: stop inertia, store the pivot */
	GESTURE_TAP,         /* one finger touched briefly */
	GESTURE_DOUBLE_TAP,  /* the second of two taps */
	GESTURE_DRAG_BEGIN,  /* one finger moved beyond the slop; x, y is where it came down */
	GESTURE_DRAG,        /* moved by dx, dy since the last report */
	GESTURE_DRAG_END,    /* its velocities are those of the fling */
	GESTURE_PINCH_BEGIN, /* two fingers; x, y is their midpoint */
	GESTURE_PINCH,       /* since the last report: dx, dy of the midpoint, scale, turn */
	GESTURE_PINCH_END,
	GESTURE_CANCEL, /* the gesture in progress ends without inertia */
};

struct gesture {
	enum gesture_kind kind;
	float x_px, y_px;   /* position: of the finger, or the midpoint of two */
	float dx_px, dy_px; /* since the last report */
	/* factor of the distance of the fingers since the last report; 1 where not a pinch */
	float scale;
	/* rotation of the line through both since the last report, clockwise on screen */
	float turn_rad;
	float vx_px_per_s, vy_px_per_s; /* at an end: velocity of the finger or the midpoint */
	float scale_per_s;              /* at an end: rate of ln(distance) */
	float turn_rad_per_s;           /* at an end */
	int64_t time_us;
};

struct gesture_options {
	float slop_px;     /* moving farther than this is a drag, not a tap (about 3 mm) */
	float near_px;     /* a second tap lies within this of the first (about 10 mm) */
	uint32_t tap_us;   /* a longer press is not a tap; 0: 500 ms */
	uint32_t again_us; /* longest time between the lifts of two taps; 0: 400 ms */
	/* called from gesture_feed; may be NULL */
	void (*gesture)(void *data, const struct gesture *gesture);
	void *data;
};

enum { GESTURE_HISTORY = 8 };

struct gesture_finger {
	bool down;
	float x_px, y_px;
	float down_x_px, down_y_px;
	int64_t down_us;
};

/* Private; declared here so that it can be a member. */
struct gesture_sample {
	int64_t time_us;
	float x_px, y_px, log_distance, angle_rad;
};

struct gesture_recogniser {
	struct gesture_options options;
	struct gesture_finger fingers[TOUCH_CONTACTS_MAX];
	enum {
		GESTURE_IDLE,
		GESTURE_PRESSED,
		GESTURE_DRAGGING,
		GESTURE_PINCHING,
		GESTURE_SPENT
	} state;
	uint32_t first, second; /* contacts of the running gesture */
	struct gesture_sample history[GESTURE_HISTORY];
	uint32_t history_count;
	struct gesture_sample last; /* sample at the last report */
	bool tapped;                /* a first tap was reported */
	int64_t tap_us;
	float tap_x_px, tap_y_px;
};

/* Initialises a recogniser; options are copied. */
void gesture_init(struct gesture_recogniser *recogniser, const struct gesture_options *options);
/* Forgets all fingers and what they were doing, with the same options: fingers that are still down
 * report nothing until they touch anew. */
void gesture_reset(struct gesture_recogniser *recogniser);
/* Processes an event and reports the resulting gestures before it returns. Contacts from
 * TOUCH_CONTACTS_MAX on are ignored. */
void gesture_feed(struct gesture_recogniser *recogniser, const struct touch_event *event);

#endif
