#include <string.h>

#include "app/follow.h"
#include "app/kiosk.h"
#include "base/clock.h"
#include "tests/check.h"

/* What trial.c asks of the others, as the test says. */
static struct {
	int64_t now_ms;
	bool on_trial, has_before, dark, broken_words;
	uint32_t refused;
	int card, page, proven, returned;
} world;

static struct kiosk kiosk;
static int some_thing; /* for pointers that nobody looks behind */

int64_t clock_now_ms(void)
{
	return world.now_ms;
}

bool follow_on_trial(const struct follow *follow)
{
	(void)follow;
	return world.on_trial;
}

bool follow_has_before(const struct follow *follow)
{
	(void)follow;
	return world.has_before;
}

void follow_prove(struct follow *follow)
{
	(void)follow;
	world.proven++;
	world.on_trial = false;
}

void follow_fall_back(struct follow *follow, const char *why)
{
	(void)follow;
	CHECK(why[0]);
	world.returned++;
	world.on_trial = false;
}

uint32_t scene_refused(const struct scene *scene)
{
	(void)scene;
	return world.refused;
}

bool story_broken(const struct story *story)
{
	(void)story;
	return world.broken_words;
}

struct overlay *story_overlay(struct story *story)
{
	return (struct overlay *)story;
}

int overlay_card(const struct overlay *overlay)
{
	(void)overlay;
	return world.card;
}

int overlay_page(const struct overlay *overlay)
{
	(void)overlay;
	return world.page;
}

bool display_is_dark(const struct display *display)
{
	(void)display;
	return world.dark;
}

/* A release on trial has just come onto the panel; its root page is there, nothing is drawn. */
static int set_up(void **state)
{
	(void)state;
	memset(&world, 0, sizeof(world));
	memset(&kiosk, 0, sizeof(kiosk));
	world.now_ms = 1000000;
	world.on_trial = world.has_before = true;
	world.card = world.page = -1;
	kiosk.shown.scene = (struct scene *)&some_thing;
	kiosk.shown.story = (struct story *)&some_thing;
	kiosk.shown.root_here = true;
	kiosk.shown.shown_ms = world.now_ms;
	return 0;
}

static void draw(uint32_t patches)
{
	kiosk.last_frame_ms = world.now_ms;
	kiosk.shown.frame.patches = patches;
}

static void after(int64_t ms)
{
	world.now_ms += ms;
	trial_watch(&kiosk);
}

static void waits_until_nobody_touches(void **state)
{
	(void)state;
	draw(9);
	CHECK(trial_visitor_ms(&kiosk) == 0); /* nobody ever did */
	kiosk.touched_ms = world.now_ms;
	CHECK(trial_visitor_ms(&kiosk) == 20000);
	world.now_ms += 19999;
	CHECK(trial_visitor_ms(&kiosk) == 1);
	world.now_ms += 1;
	CHECK(trial_visitor_ms(&kiosk) == 0);
}

static void waits_longer_while_something_is_open_or_lies_there(void **state)
{
	(void)state;
	draw(9);
	kiosk.touched_ms = world.now_ms;
	world.now_ms += 20000;
	world.card = 3;
	CHECK(trial_visitor_ms(&kiosk) == 160000);
	world.card = -1;
	world.page = 3;
	CHECK(trial_visitor_ms(&kiosk) == 160000);
	world.page = -1;
	CHECK(trial_visitor_ms(&kiosk) == 0);
	kiosk.gestures.fingers[2].down = true;
	CHECK(trial_visitor_ms(&kiosk) == 160000);
	world.now_ms += 160000; /* it is no finger */
	CHECK(trial_visitor_ms(&kiosk) == 0);
}

static void waits_for_nobody_where_nothing_is_to_be_seen(void **state)
{
	(void)state;
	kiosk.touched_ms = world.now_ms;
	draw(0);
	CHECK(trial_visitor_ms(&kiosk) == 0);
}

static void proves_what_was_seen_for_a_while(void **state)
{
	(void)state;
	CHECK(trial_wait_ms(&kiosk) > 0);
	draw(9);
	after(0);
	CHECK(world.proven == 0 && trial_wait_ms(&kiosk) == 10000);
	after(9999);
	CHECK(world.proven == 0);
	after(1);
	CHECK(world.proven == 1 && world.returned == 0 && trial_wait_ms(&kiosk) == -1);
}

static void proves_nothing_by_the_frame_before_it(void **state)
{
	(void)state;
	kiosk.last_frame_ms = kiosk.shown.shown_ms - 1; /* of the release before */
	kiosk.shown.frame.patches = 9;                  /* small and unseen */
	after(20000);
	CHECK(world.proven == 0);
	world.dark = true;
	draw(9);
	after(20000);
	CHECK(world.proven == 0); /* on a panel that sleeps */
	world.dark = false;
	draw(9);
	after(0);
	after(10000);
	CHECK(world.proven == 1);
}

static void returns_from_what_cannot_be_decoded(void **state)
{
	(void)state;
	world.refused = 1;
	after(0);
	CHECK(world.returned == 1);
	set_up(NULL);
	world.broken_words = true;
	after(0);
	CHECK(world.returned == 1);
	set_up(NULL);
	world.refused = 1;
	draw(9); /* one tile of many: it shows */
	after(0);
	CHECK(world.returned == 0);
}

static void returns_from_what_shows_nothing(void **state)
{
	(void)state;
	after(59999);
	CHECK(world.returned == 0 && trial_wait_ms(&kiosk) == 1);
	after(1);
	CHECK(world.returned == 1);
}

static void blames_no_release_for_the_network(void **state)
{
	(void)state;
	kiosk.wants.said_count = 1;
	after(3600000);
	CHECK(world.returned == 0 && trial_wait_ms(&kiosk) == -1);
}

static void has_nowhere_to_return_at_first(void **state)
{
	(void)state;
	world.has_before = false;
	world.refused = 1;
	after(3600000);
	CHECK(world.returned == 0 && trial_wait_ms(&kiosk) == -1);
	draw(9);
	after(0);
	after(10000);
	CHECK(world.proven == 1);
}

static void leaves_a_proven_release_alone(void **state)
{
	(void)state;
	world.on_trial = false;
	world.refused = 1;
	after(3600000);
	CHECK(world.returned == 0 && world.proven == 0 && trial_wait_ms(&kiosk) == -1);
}

#define ON_TRIAL(test) cmocka_unit_test_setup(test, set_up)

int main(void)
{
	const struct CMUnitTest tests[] = {
		ON_TRIAL(waits_until_nobody_touches),
		ON_TRIAL(waits_longer_while_something_is_open_or_lies_there),
		ON_TRIAL(waits_for_nobody_where_nothing_is_to_be_seen),
		ON_TRIAL(proves_what_was_seen_for_a_while),
		ON_TRIAL(proves_nothing_by_the_frame_before_it),
		ON_TRIAL(returns_from_what_cannot_be_decoded),
		ON_TRIAL(returns_from_what_shows_nothing),
		ON_TRIAL(blames_no_release_for_the_network),
		ON_TRIAL(has_nowhere_to_return_at_first),
		ON_TRIAL(leaves_a_proven_release_alone),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
