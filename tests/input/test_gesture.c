/* Scripted fingers: what they mean does not depend on any clock. */
#include "input/gesture.h"

#include <math.h>
#include <string.h>

#include "tests/check.h"

enum { SEEN_MAX = 200 };

static struct gesture seen[SEEN_MAX];
static uint32_t seen_count;
static struct gesture_recogniser recogniser;

static void note(void *data, const struct gesture *gesture)
{
	(void)data;
	if (seen_count < SEEN_MAX)
		seen[seen_count++] = *gesture;
}

static void start(void)
{
	const struct gesture_options options = { .slop_px = 10, .near_px = 30, .gesture = note };

	gesture_init(&recogniser, &options);
	seen_count = 0;
}

static void finger(enum touch_phase phase, uint32_t contact, float x, float y, int t_ms)
{
	const struct touch_event event = { phase, contact, x, y, (int64_t)t_ms * 1000 };

	gesture_feed(&recogniser, &event);
}

static uint32_t count(enum gesture_kind kind)
{
	uint32_t found = 0;

	for (uint32_t i = 0; i < seen_count; i++)
		found += seen[i].kind == kind;
	return found;
}

static const struct gesture *last(enum gesture_kind kind)
{
	for (uint32_t i = seen_count; i-- > 0;)
		if (seen[i].kind == kind)
			return &seen[i];
	fail_msg("gesture %d was not seen", (int)kind);
	return NULL;
}

static bool near(float a, float b)
{
	return fabsf(a - b) < 0.01f * fmaxf(1, fabsf(b));
}

static void a_short_still_touch_is_a_tap(void **state)
{
	(void)state;
	start();
	finger(TOUCH_DOWN, 3, 100, 50, 0);
	finger(TOUCH_MOVE, 3, 104, 52, 40); /* within the slop */
	finger(TOUCH_UP, 3, 104, 52, 90);
	CHECK(seen_count == 2 && seen[0].kind == GESTURE_PRESS && seen[1].kind == GESTURE_TAP);
	CHECK(seen[1].x_px == 104 && seen[1].time_us == 90000);
}

static void two_taps_near_and_soon_are_a_double_tap(void **state)
{
	(void)state;
	start();
	finger(TOUCH_DOWN, 0, 100, 50, 0);
	finger(TOUCH_UP, 0, 100, 50, 80);
	finger(TOUCH_DOWN, 0, 110, 60, 200);
	finger(TOUCH_UP, 0, 110, 60, 280);
	CHECK(count(GESTURE_TAP) == 1 && count(GESTURE_DOUBLE_TAP) == 1);
	finger(TOUCH_DOWN, 0, 110, 60, 400); /* a third one begins anew */
	finger(TOUCH_UP, 0, 110, 60, 450);
	CHECK(count(GESTURE_TAP) == 2 && count(GESTURE_DOUBLE_TAP) == 1);
}

static void far_or_late_taps_are_single(void **state)
{
	(void)state;
	start();
	finger(TOUCH_DOWN, 0, 100, 50, 0);
	finger(TOUCH_UP, 0, 100, 50, 80);
	finger(TOUCH_DOWN, 0, 200, 50, 150); /* far */
	finger(TOUCH_UP, 0, 200, 50, 220);
	finger(TOUCH_DOWN, 0, 200, 50, 900); /* late */
	finger(TOUCH_UP, 0, 200, 50, 950);
	CHECK(count(GESTURE_TAP) == 3 && count(GESTURE_DOUBLE_TAP) == 0);
}

static void a_long_press_is_no_tap(void **state)
{
	(void)state;
	start();
	finger(TOUCH_DOWN, 0, 100, 50, 0);
	finger(TOUCH_UP, 0, 100, 50, 800);
	CHECK(count(GESTURE_TAP) == 0 && count(GESTURE_PRESS) == 1);
}

static void a_drag_adds_up_and_is_flung(void **state)
{
	float dx = 0, dy = 0;

	(void)state;
	start();
	finger(TOUCH_DOWN, 0, 100, 100, 0);
	for (int i = 1; i <= 20; i++) /* 600 px/s to the right, 300 down */
		finger(TOUCH_MOVE, 0, 100 + 6 * (float)i, 100 + 3 * (float)i, i * 10);
	finger(TOUCH_UP, 0, 220, 160, 205);
	CHECK(count(GESTURE_DRAG_BEGIN) == 1 && last(GESTURE_DRAG_BEGIN)->x_px == 100);
	for (uint32_t i = 0; i < seen_count; i++) {
		if (seen[i].kind == GESTURE_DRAG) {
			dx += seen[i].dx_px;
			dy += seen[i].dy_px;
			CHECK(seen[i].scale == 1 && seen[i].turn_rad == 0);
		}
	}
	CHECK(near(dx, 108) && near(dy, 54)); /* all but the slop's two steps */
	CHECK(near(last(GESTURE_DRAG_END)->vx_px_per_s, 600));
	CHECK(near(last(GESTURE_DRAG_END)->vy_px_per_s, 300));
	CHECK(count(GESTURE_TAP) == 0);
}

static void a_rested_finger_flings_nothing(void **state)
{
	(void)state;
	start();
	finger(TOUCH_DOWN, 0, 100, 100, 0);
	for (int i = 1; i <= 10; i++)
		finger(TOUCH_MOVE, 0, 100 + 10 * (float)i, 100, i * 10);
	finger(TOUCH_UP, 0, 200, 100, 400);
	CHECK(last(GESTURE_DRAG_END)->vx_px_per_s == 0);
}

static void a_pinch_scales_turns_and_shifts(void **state)
{
	float scale = 1, turn = 0, dx = 0, dy = 0;
	const int steps = 30;

	(void)state;
	start();
	finger(TOUCH_DOWN, 0, 400, 300, 0);
	finger(TOUCH_DOWN, 1, 600, 300, 5);
	CHECK(last(GESTURE_PINCH_BEGIN)->x_px == 500);
	for (int i = 1; i <= steps; i++) { /* twice as far, 3/4 of a turn, shifted by 60, 30 */
		float t = (float)i / (float)steps, half = 100 * (1 + t);
		float angle = t * 1.5f * (float)M_PI;
		float x = 500 + 60 * t, y = 300 + 30 * t;

		finger(TOUCH_MOVE, 0, x - half * cosf(angle), y - half * sinf(angle), 5 + 10 * i);
		finger(TOUCH_MOVE, 1, x + half * cosf(angle), y + half * sinf(angle), 5 + 10 * i);
	}
	finger(TOUCH_UP, 1, 0, 0, 310);
	for (uint32_t i = 0; i < seen_count; i++) {
		if (seen[i].kind == GESTURE_PINCH) {
			scale *= seen[i].scale;
			turn += seen[i].turn_rad;
			dx += seen[i].dx_px;
			dy += seen[i].dy_px;
		}
	}
	CHECK(near(scale, 2) && near(turn, 1.5f * (float)M_PI));
	CHECK(near(dx, 60) && near(dy, 30));
	CHECK(last(GESTURE_PINCH_END)->scale_per_s > 1);
	CHECK(last(GESTURE_PINCH_END)->turn_rad_per_s > 5);
	CHECK(count(GESTURE_TAP) == 0 && count(GESTURE_DRAG) == 0);
}

/* The finger that stays after a pinch drags on, without a jump and without a tap at its end. */
static void the_finger_that_stays_drags_on(void **state)
{
	(void)state;
	start();
	finger(TOUCH_DOWN, 0, 100, 100, 0);
	finger(TOUCH_DOWN, 1, 300, 100, 10);
	finger(TOUCH_MOVE, 1, 320, 100, 20);
	finger(TOUCH_UP, 0, 100, 100, 30);
	finger(TOUCH_MOVE, 1, 323, 100, 40); /* within the slop */
	CHECK(count(GESTURE_DRAG_BEGIN) == 0);
	finger(TOUCH_MOVE, 1, 340, 100, 50);
	finger(TOUCH_MOVE, 1, 350, 100, 60);
	CHECK(last(GESTURE_DRAG_BEGIN)->x_px == 320 && near(last(GESTURE_DRAG)->dx_px, 10));
	finger(TOUCH_UP, 1, 350, 100, 70);
	CHECK(count(GESTURE_DRAG_END) == 1);

	start();
	finger(TOUCH_DOWN, 0, 100, 100, 0);
	finger(TOUCH_DOWN, 1, 300, 100, 10);
	finger(TOUCH_UP, 0, 100, 100, 30);
	finger(TOUCH_UP, 1, 300, 100, 40);
	CHECK(count(GESTURE_TAP) == 0 && count(GESTURE_PINCH_END) == 1);
}

static void a_drag_goes_over_into_a_pinch(void **state)
{
	(void)state;
	start();
	finger(TOUCH_DOWN, 0, 100, 100, 0);
	finger(TOUCH_MOVE, 0, 150, 100, 10);
	finger(TOUCH_DOWN, 1, 300, 100, 20);
	CHECK(last(GESTURE_DRAG_END)->vx_px_per_s == 0); /* no inertia under a pinch */
	CHECK(count(GESTURE_PINCH_BEGIN) == 1);
	finger(TOUCH_DOWN, 2, 500, 500, 30); /* a third finger changes nothing */
	finger(TOUCH_MOVE, 2, 600, 600, 40);
	finger(TOUCH_UP, 2, 600, 600, 50);
	CHECK(count(GESTURE_PINCH) == 0 && count(GESTURE_PINCH_END) == 0);
}

static void a_palm_cancels(void **state)
{
	(void)state;
	start();
	finger(TOUCH_DOWN, 0, 100, 100, 0);
	finger(TOUCH_CANCEL, 0, 100, 100, 50);
	CHECK(count(GESTURE_TAP) == 0 && count(GESTURE_CANCEL) == 1);
	finger(TOUCH_DOWN, 0, 100, 100, 100); /* and the next finger is one again */
	finger(TOUCH_UP, 0, 100, 100, 150);
	CHECK(count(GESTURE_TAP) == 1);
}

/* Whatever the order of events, every begin has its end and numbers stay finite. */
static void random_fingers_leave_nothing_open(void **state)
{
	uint32_t random = 7;

	(void)state;
	for (int run = 0; run < 500; run++) {
		int drags = 0, pinches = 0, t_ms = 0;

		start();
		for (int i = 0; i < 40; i++) {
			uint32_t contact;
			enum touch_phase phase;

			random = random * 1664525u + 1013904223u;
			contact = (random >> 8) % 12; /* some are out of range */
			phase = (enum touch_phase)((random >> 16) % 4);
			t_ms += (int)((random >> 20) % 30);
			finger(phase, contact, (float)((random >> 4) % 800),
			       (float)((random >> 12) % 600), t_ms);
		}
		for (uint32_t c = 0; c < TOUCH_CONTACTS_MAX; c++)
			finger(TOUCH_UP, c, 1, 1, t_ms + 10);
		for (uint32_t i = 0; i < seen_count; i++) {
			const struct gesture *g = &seen[i];

			CHECK(isfinite(g->dx_px) && isfinite(g->scale) && g->scale > 0);
			CHECK(isfinite(g->turn_rad) && isfinite(g->vx_px_per_s));
			drags += g->kind == GESTURE_DRAG_BEGIN;
			drags -= g->kind == GESTURE_DRAG_END;
			pinches += g->kind == GESTURE_PINCH_BEGIN;
			pinches -= g->kind == GESTURE_PINCH_END;
			if (g->kind == GESTURE_CANCEL)
				drags = pinches = 0;
			CHECK(drags >= 0 && drags <= 1 && pinches >= 0 && pinches <= 1);
		}
		CHECK(drags == 0 && pinches == 0 && recogniser.state == GESTURE_IDLE);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_short_still_touch_is_a_tap),
		cmocka_unit_test(two_taps_near_and_soon_are_a_double_tap),
		cmocka_unit_test(far_or_late_taps_are_single),
		cmocka_unit_test(a_long_press_is_no_tap),
		cmocka_unit_test(a_drag_adds_up_and_is_flung),
		cmocka_unit_test(a_rested_finger_flings_nothing),
		cmocka_unit_test(a_pinch_scales_turns_and_shifts),
		cmocka_unit_test(the_finger_that_stays_drags_on),
		cmocka_unit_test(a_drag_goes_over_into_a_pinch),
		cmocka_unit_test(a_palm_cancels),
		cmocka_unit_test(random_fingers_leave_nothing_open),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
