#include <string.h>

#include "app/kiosk.h"
#include "app/release/updater.h"
#include "base/clock.h"
#include "tests/check.h"

/* What trial.c asks of the others, as the test says. */
static struct {
	int64_t now_ms;
	bool on_trial, has_before, dark, broken_words;
	uint32_t refused;
	int proven, returned;
} world;

static struct kiosk kiosk;
static int some_thing; /* for pointers that nobody looks behind */

int64_t clock_now_ms(void)
{
	return world.now_ms;
}

bool updater_on_trial(const struct updater *updater)
{
	(void)updater;
	return world.on_trial;
}

bool updater_has_before(const struct updater *updater)
{
	(void)updater;
	return world.has_before;
}

void updater_prove(struct updater *updater)
{
	(void)updater;
	world.proven++;
	world.on_trial = false;
}

void updater_fall_back(struct updater *updater, const char *why)
{
	(void)updater;
	CHECK(why[0]);
	world.returned++;
	world.on_trial = false;
}

uint32_t scene_refused(const struct scene *scene)
{
	(void)scene;
	return world.refused;
}

bool information_view_broken(const struct information_view *view)
{
	(void)view;
	return world.broken_words;
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
	kiosk.shown.scene = (struct scene *)&some_thing;
	kiosk.shown.view = (struct information_view *)&some_thing;
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
