/* A day of the panel: display, clocks and service manager are played. 1 July 2024 was a Monday. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "app/panel.h"
#include "base/clock.h"
#include "base/service.h"
#include "render/display/shift.h"
#include "tests/check.h"

enum { MONDAY_NOON_S = 1719835200, HOUR_S = 3600, NEVER = -1 };

static struct viewport viewport;
static struct redraw redraw;
static struct panel panel;
static int64_t frame_ms;
static int64_t now_ms, wall_s, due_ms;
static bool plausible, dark, ready, asleep, stale;
static int sleeps, wakes, readies, alives, redraws, dispatches, sleep_rc, wait;

int64_t clock_now_ms(void)
{
	return now_ms;
}

int64_t clock_wall_s(void)
{
	return wall_s;
}

bool clock_wall_is_plausible(void)
{
	return plausible;
}

int display_wait_ms(const struct display *display)
{
	(void)display;
	return wait;
}

int display_dispatch(struct display *display)
{
	(void)display;
	dispatches++;
	return 0;
}

bool display_ready(const struct display *display)
{
	(void)display;
	return ready && !asleep && !dark;
}

bool display_is_dark(const struct display *display)
{
	(void)display;
	return dark || asleep;
}

bool display_take_stale(struct display *display)
{
	const bool was = stale;

	(void)display;
	stale = false;
	return was;
}

int display_sleep(struct display *display, bool wish)
{
	(void)display;
	sleeps += wish;
	wakes += !wish;
	stale = !wish;
	asleep = wish;
	return sleep_rc;
}

void service_ready(void)
{
	readies++;
}

int64_t service_due_ms(void)
{
	return due_ms;
}

void service_alive(void)
{
	alives++;
}

/* ---- */

static int begin(void **state)
{
	(void)state;
	setenv("TZ", "UTC", 1);
	panel_init(&panel, &(struct panel_options){
				   .wake_min = 5, .viewport = &viewport, .redraw = &redraw });
	hours_always(&panel.options.hours);
	viewport = (struct viewport){ 0 };
	redraw.wanted = false;
	frame_ms = 0;
	now_ms = 1000000;
	wall_s = MONDAY_NOON_S;
	due_ms = INT64_MAX;
	plausible = ready = true;
	dark = asleep = stale = false;
	wait = NEVER;
	sleeps = wakes = readies = alives = redraws = dispatches = sleep_rc = 0;
	return 0;
}

/* A turn of the loop; a frame that it asks for is counted. */
static void turn(void)
{
	redraw.wanted = false;
	CHECK(panel_turn(&panel, frame_ms) == 0);
	redraws += redraw.wanted;
}

static void pass(int64_t seconds)
{
	now_ms += seconds * 1000;
	wall_s += seconds;
	turn();
}

static void keep(const char *hours)
{
	CHECK(hours_parse(&panel.options.hours, hours));
	turn();
}

static bool touch(enum touch_phase phase, uint32_t contact)
{
	const struct touch_event event = { .phase = phase, .contact = contact };

	return panel_take_touch(&panel, &event);
}

static void is_on_without_hours(void **state)
{
	(void)state;
	for (int hour = 0; hour < 7 * 24; hour++)
		pass(HOUR_S);
	CHECK(sleeps == 0 && panel_wait_ms(&panel) == NEVER);
}

static void is_off_outside_its_hours(void **state)
{
	(void)state;
	keep("Mo-Fr 09:00-18:00");
	CHECK(sleeps == 0);
	for (int minute = 0; minute < 6 * 60; minute++)
		pass(60);
	CHECK(sleeps == 1); /* at six in the evening */
	for (int minute = 0; minute < 15 * 60; minute++)
		pass(60);
	CHECK(sleeps == 1 && wakes == 1 && redraws == 1); /* at nine in the morning */
}

static void starts_off_at_night(void **state)
{
	(void)state;
	wall_s += 10 * HOUR_S;
	keep("Mo-Fr 09:00-18:00");
	CHECK(sleeps == 1 && readies == 1); /* and the service manager knows that all is well */
}

static void looks_at_the_clock_now_and_then(void **state)
{
	(void)state;
	keep("Mo 09:00-18:00");
	CHECK(panel_wait_ms(&panel) == 30000);
	wall_s += 12 * HOUR_S; /* somebody set it */
	pass(29);
	CHECK(sleeps == 0);
	pass(1);
	CHECK(sleeps == 1);
}

static void a_clock_that_nobody_set_closes_nothing(void **state)
{
	(void)state;
	plausible = false;
	keep("Tu 09:00-18:00");
	pass(60);
	CHECK(sleeps == 0);
	plausible = true;
	pass(60);
	CHECK(sleeps == 1);
}

static void a_touch_wakes_it_for_some_minutes(void **state)
{
	(void)state;
	keep("Tu 09:00-18:00");
	CHECK(sleeps == 1);
	CHECK(touch(TOUCH_DOWN, 0)); /* means nothing else */
	pass(0);
	CHECK(wakes == 1);
	CHECK(touch(TOUCH_MOVE, 0) && touch(TOUCH_UP, 0));
	CHECK(!touch(TOUCH_DOWN, 0) && !touch(TOUCH_UP, 0)); /* the next one is a visitor's */
	pass(299);
	CHECK(sleeps == 1);
	pass(31);
	CHECK(sleeps == 2);
}

static void a_touch_need_not_wake_it(void **state)
{
	(void)state;
	panel.options.wake_min = 0;
	keep("Tu 09:00-18:00");
	CHECK(touch(TOUCH_DOWN, 3) && touch(TOUCH_CANCEL, 3));
	pass(1);
	CHECK(wakes == 0 && asleep);
}

static void closing_time_sends_nobody_away(void **state)
{
	(void)state;
	keep("Mo 09:00-12:01");
	for (int i = 0; i < 20; i++) {
		CHECK(!touch(TOUCH_DOWN, 0) && !touch(TOUCH_UP, 0));
		pass(60);
	}
	CHECK(sleeps == 0);
	pass(301);
	CHECK(sleeps == 1);
}

static void waits_for_the_flip_before_it_sleeps(void **state)
{
	(void)state;
	ready = false;
	keep("Tu 09:00-18:00");
	CHECK(sleeps == 0);
	ready = true;
	pass(0);
	CHECK(sleeps == 1);
}

static void another_panel_after_the_night_ends_the_process(void **state)
{
	(void)state;
	keep("Tu 09:00-18:00");
	sleep_rc = -ESTALE;
	CHECK(touch(TOUCH_DOWN, 0));
	CHECK(panel_turn(&panel, frame_ms) == -ESTALE);
}

static void is_well_in_the_dark_when_the_loop_turns(void **state)
{
	(void)state;
	dark = true;
	due_ms = now_ms + 500;
	pass(0);
	CHECK(readies == 1 && alives == 0 && panel_wait_ms(&panel) == 500);
	pass(1);
	CHECK(alives == 1 && redraws == 0);
}

static void is_not_well_when_a_picture_hangs(void **state)
{
	(void)state;
	frame_ms = now_ms;
	ready = false;
	due_ms = now_ms;
	pass(1);
	CHECK(readies == 0 && alives == 0);
	wait = 700;
	CHECK(panel_wait_ms(&panel) == 700); /* and does not turn for nothing meanwhile */
}

static void draws_at_rest_to_know_that_it_is_well(void **state)
{
	(void)state;
	frame_ms = now_ms;
	due_ms = now_ms;
	pass(1);
	CHECK(readies == 1 && alives == 0 && redraws == 1);
	frame_ms = now_ms;
	pass(1);
	CHECK(alives == 1);
}

static void looks_at_the_display_when_it_asks(void **state)
{
	(void)state;
	wait = 0;
	pass(1);
	CHECK(dispatches == 1);
	wait = 20;
	pass(1);
	CHECK(dispatches == 1 && panel_wait_ms(&panel) == 20);
}

static void shifts_the_picture_only_where_it_is_asked_to(void **state)
{
	(void)state;
	pass(600);
	CHECK(redraws == 0 && viewport.shift_px[0] == 0 && viewport.shift_px[1] == 0);
	panel.options.shift = true;
	pass(0);
	CHECK(panel_wait_ms(&panel) > 0 && panel_wait_ms(&panel) <= SHIFT_STEP_MS);
	redraws = 0;
	for (int second = 0; second < 400; second++)
		pass(1);
	CHECK(redraws == 10 || redraws == 9); /* at an end it turns on its heel */
}

int main(void)
{
#define CASE(name) cmocka_unit_test_setup(name, begin)
	const struct CMUnitTest tests[] = {
		CASE(is_on_without_hours),
		CASE(is_off_outside_its_hours),
		CASE(starts_off_at_night),
		CASE(looks_at_the_clock_now_and_then),
		CASE(a_clock_that_nobody_set_closes_nothing),
		CASE(a_touch_wakes_it_for_some_minutes),
		CASE(a_touch_need_not_wake_it),
		CASE(closing_time_sends_nobody_away),
		CASE(waits_for_the_flip_before_it_sleeps),
		CASE(another_panel_after_the_night_ends_the_process),
		CASE(is_well_in_the_dark_when_the_loop_turns),
		CASE(is_not_well_when_a_picture_hangs),
		CASE(draws_at_rest_to_know_that_it_is_well),
		CASE(looks_at_the_display_when_it_asks),
		CASE(shifts_the_picture_only_where_it_is_asked_to),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
