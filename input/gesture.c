/* The state machine from touch events to taps, drags and pinches, with velocities from the last
 * samples. */
#include "input/gesture.h"

#include <math.h>
#include <string.h>

enum {
	TAP_US = 500 * 1000,
	AGAIN_US = 400 * 1000,
	VELOCITY_WINDOW_US = 100 * 1000, /* the velocity of a fling is measured over this time */
	REST_US = 60 * 1000,             /* a finger that rested longer than this has no velocity */
};

#define PINCH_LEAST_PX 8.0f /* smaller distances of two fingers count as this */

static void emit(struct gesture_recogniser *r, struct gesture gesture)
{
	if (gesture.scale == 0)
		gesture.scale = 1;
	if (r->options.gesture)
		r->options.gesture(r->options.data, &gesture);
}

static void emit_at(struct gesture_recogniser *r, enum gesture_kind kind, float x_px, float y_px,
		    int64_t time_us)
{
	emit(r, (struct gesture){ .kind = kind, .x_px = x_px, .y_px = y_px, .time_us = time_us });
}

void gesture_init(struct gesture_recogniser *recogniser, const struct gesture_options *options)
{
	memset(recogniser, 0, sizeof(*recogniser));
	recogniser->options = *options;
	if (!options->tap_us)
		recogniser->options.tap_us = TAP_US;
	if (!options->again_us)
		recogniser->options.again_us = AGAIN_US;
}

void gesture_reset(struct gesture_recogniser *recogniser)
{
	const struct gesture_options options = recogniser->options;

	gesture_init(recogniser, &options);
}

/* ---- samples ---- */

/* Returns the state of the gesture now: the finger, or the midpoint, distance and direction of two.
 * The angle continues beyond half a turn, so differences never wrap. */
static struct gesture_sample sample_now(const struct gesture_recogniser *r, int64_t time_us)
{
	const struct gesture_finger *a = &r->fingers[r->first], *b = &r->fingers[r->second];
	struct gesture_sample sample = { .time_us = time_us, .x_px = a->x_px, .y_px = a->y_px };
	float dx = b->x_px - a->x_px, dy = b->y_px - a->y_px, turn;

	if (r->state != GESTURE_PINCHING)
		return sample;
	sample.x_px = (a->x_px + b->x_px) / 2;
	sample.y_px = (a->y_px + b->y_px) / 2;
	sample.log_distance = logf(fmaxf(hypotf(dx, dy), PINCH_LEAST_PX));
	turn = remainderf(atan2f(dy, dx) - r->last.angle_rad, 2 * (float)M_PI);
	sample.angle_rad = r->last.angle_rad + turn;
	return sample;
}

static void remember(struct gesture_recogniser *r, struct gesture_sample sample)
{
	if (r->history_count == GESTURE_HISTORY) {
		memmove(&r->history[0], &r->history[1],
			(GESTURE_HISTORY - 1) * sizeof(r->history[0]));
		r->history_count--;
	}
	r->history[r->history_count++] = sample;
	r->last = sample;
}

static void begin(struct gesture_recogniser *r, enum gesture_kind kind, int64_t time_us)
{
	const struct gesture_finger *finger = &r->fingers[r->first];
	struct gesture_sample sample;

	r->history_count = 0;
	r->last = (struct gesture_sample){ 0 };
	sample = sample_now(r, time_us);
	remember(r, sample);
	if (kind == GESTURE_DRAG_BEGIN)
		emit_at(r, kind, finger->down_x_px, finger->down_y_px, time_us);
	else
		emit_at(r, kind, sample.x_px, sample.y_px, time_us);
}

static void go_on(struct gesture_recogniser *r, enum gesture_kind kind, int64_t time_us)
{
	struct gesture_sample before = r->last, now = sample_now(r, time_us);

	remember(r, now);
	emit(r, (struct gesture){ .kind = kind,
				  .x_px = now.x_px,
				  .y_px = now.y_px,
				  .dx_px = now.x_px - before.x_px,
				  .dy_px = now.y_px - before.y_px,
				  .scale = expf(now.log_distance - before.log_distance),
				  .turn_rad = now.angle_rad - before.angle_rad,
				  .time_us = time_us });
}

/* Ends a gesture with the velocities of the last moment; none where the fingers rested before they
 * lifted. */
static void end(struct gesture_recogniser *r, enum gesture_kind kind, int64_t time_us)
{
	const struct gesture_sample *last = &r->last, *first = last;
	struct gesture gesture = {
		.kind = kind, .x_px = last->x_px, .y_px = last->y_px, .time_us = time_us
	};
	float seconds;

	for (uint32_t i = r->history_count; i-- > 0;)
		if (time_us - r->history[i].time_us <= VELOCITY_WINDOW_US)
			first = &r->history[i];
	seconds = (float)(last->time_us - first->time_us) / 1e6f;
	if (seconds > 0 && time_us - last->time_us <= REST_US) {
		gesture.vx_px_per_s = (last->x_px - first->x_px) / seconds;
		gesture.vy_px_per_s = (last->y_px - first->y_px) / seconds;
		gesture.scale_per_s = (last->log_distance - first->log_distance) / seconds;
		gesture.turn_rad_per_s = (last->angle_rad - first->angle_rad) / seconds;
	}
	emit(r, gesture);
}

/* ---- fingers ---- */

/* Returns a finger that is down other than this one, or TOUCH_CONTACTS_MAX. */
static uint32_t other_finger(const struct gesture_recogniser *r, uint32_t but)
{
	for (uint32_t i = 0; i < TOUCH_CONTACTS_MAX; i++)
		if (i != but && r->fingers[i].down)
			return i;
	return TOUCH_CONTACTS_MAX;
}

/* After a gesture: a finger that stays down may start a drag, but not a tap. */
static void hand_over(struct gesture_recogniser *r, uint32_t finger)
{
	r->state = GESTURE_IDLE;
	if (finger == TOUCH_CONTACTS_MAX)
		return;
	r->state = GESTURE_SPENT;
	r->first = finger;
	r->fingers[finger].down_x_px = r->fingers[finger].x_px;
	r->fingers[finger].down_y_px = r->fingers[finger].y_px;
}

static void on_down(struct gesture_recogniser *r, const struct touch_event *event)
{
	struct gesture_finger *finger = &r->fingers[event->contact];

	*finger = (struct gesture_finger){ .down = true,
					   .x_px = event->x_px,
					   .y_px = event->y_px,
					   .down_x_px = event->x_px,
					   .down_y_px = event->y_px,
					   .down_us = event->time_us };
	switch (r->state) {
	case GESTURE_IDLE:
		r->state = GESTURE_PRESSED;
		r->first = event->contact;
		emit_at(r, GESTURE_PRESS, event->x_px, event->y_px, event->time_us);
		break;
	case GESTURE_DRAGGING:
		/* The drag becomes a pinch: its end has no velocity. */
		emit_at(r, GESTURE_DRAG_END, r->last.x_px, r->last.y_px, event->time_us);
		/* fall through */
	case GESTURE_PRESSED:
	case GESTURE_SPENT:
		r->state = GESTURE_PINCHING;
		r->second = event->contact;
		r->tapped = false;
		begin(r, GESTURE_PINCH_BEGIN, event->time_us);
		break;
	case GESTURE_PINCHING: /* a third finger changes nothing */
		break;
	}
}

static void on_move(struct gesture_recogniser *r, const struct touch_event *event)
{
	struct gesture_finger *finger = &r->fingers[event->contact];

	if (!finger->down)
		return;
	finger->x_px = event->x_px;
	finger->y_px = event->y_px;
	if (r->state == GESTURE_PINCHING) {
		if (event->contact == r->first || event->contact == r->second)
			go_on(r, GESTURE_PINCH, event->time_us);
		return;
	}
	if (event->contact != r->first || r->state == GESTURE_IDLE)
		return;
	if (r->state == GESTURE_DRAGGING) {
		go_on(r, GESTURE_DRAG, event->time_us);
	} else if (hypotf(finger->x_px - finger->down_x_px, finger->y_px - finger->down_y_px) >
		   r->options.slop_px) {
		r->state = GESTURE_DRAGGING;
		r->tapped = false;
		begin(r, GESTURE_DRAG_BEGIN, event->time_us);
	}
}

static void tap(struct gesture_recogniser *r, const struct gesture_finger *finger, int64_t time_us)
{
	bool again = r->tapped && time_us - r->tap_us <= r->options.again_us &&
		     hypotf(finger->x_px - r->tap_x_px, finger->y_px - r->tap_y_px) <=
			     r->options.near_px;

	/* A third tap counts as a first one again. */
	r->tapped = !again;
	r->tap_us = time_us;
	r->tap_x_px = finger->x_px;
	r->tap_y_px = finger->y_px;
	emit_at(r, again ? GESTURE_DOUBLE_TAP : GESTURE_TAP, finger->x_px, finger->y_px, time_us);
}

static void on_up(struct gesture_recogniser *r, const struct touch_event *event)
{
	struct gesture_finger *finger = &r->fingers[event->contact];
	bool ours = event->contact == r->first ||
		    (r->state == GESTURE_PINCHING && event->contact == r->second);

	if (!finger->down)
		return;
	finger->down = false;
	if (!ours || r->state == GESTURE_IDLE)
		return;
	if (event->phase == TOUCH_CANCEL)
		emit_at(r, GESTURE_CANCEL, finger->x_px, finger->y_px, event->time_us);
	else if (r->state == GESTURE_PINCHING)
		end(r, GESTURE_PINCH_END, event->time_us);
	else if (r->state == GESTURE_DRAGGING)
		end(r, GESTURE_DRAG_END, event->time_us);
	else if (r->state == GESTURE_PRESSED &&
		 event->time_us - finger->down_us <= r->options.tap_us)
		tap(r, finger, event->time_us);
	hand_over(r, other_finger(r, event->contact));
}

void gesture_feed(struct gesture_recogniser *recogniser, const struct touch_event *event)
{
	if (event->contact >= TOUCH_CONTACTS_MAX)
		return;
	switch (event->phase) {
	case TOUCH_DOWN:
		if (!recogniser->fingers[event->contact].down)
			on_down(recogniser, event);
		break;
	case TOUCH_MOVE:
		on_move(recogniser, event);
		break;
	case TOUCH_UP:
	case TOUCH_CANCEL:
		on_up(recogniser, event);
		break;
	}
}
