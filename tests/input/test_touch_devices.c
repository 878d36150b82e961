/* Recorded devices played through the real libevdev by umockdev, which puts them under /dev/input
 * for one process: this program runs itself again beneath umockdev-run, a case each. */
#include "input/touch.h"

#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/check.h"

enum {
	EVENTS_MAX = 64,
	SKIPPED = 77,
	SILENCE_MS = 60000, /* longer than a busy machine leaves umockdev's thread waiting */
};

struct heard {
	struct touch_event events[EVENTS_MAX];
	uint32_t count;
};

static void note(void *data, const struct touch_event *event)
{
	struct heard *heard = data;

	if (heard->count < EVENTS_MAX)
		heard->events[heard->count++] = *event;
}

#define EXPECT(claim)                                                                              \
	do {                                                                                       \
		if (!(claim)) {                                                                    \
			fprintf(stderr, "not true: %s\n", #claim);                                 \
			return 1;                                                                  \
		}                                                                                  \
	} while (0)

/* ---- beneath umockdev-run ---- */

static uint32_t ups(const struct heard *heard)
{
	uint32_t count = 0;

	for (uint32_t i = 0; i < heard->count; i++)
		count += heard->events[i].phase == TOUCH_UP ||
			 heard->events[i].phase == TOUCH_CANCEL;
	return count;
}

/* Until that many fingers have lifted, or SILENCE_MS without a sound. */
static int listen_to(struct heard *heard, const struct touch_options *given, uint32_t lifts)
{
	struct touch_options options = *given;
	struct touch *touch;
	int rc = 0;

	options.event = note;
	options.data = heard;
	if (touch_create(&touch, &options) < 0)
		return -1;
	if (touch_device_count(touch) != 1)
		fprintf(stderr, "%u devices\n", touch_device_count(touch));
	while (rc == 0 && ups(heard) < lifts) {
		struct pollfd wait = { .fd = touch_fd(touch), .events = POLLIN };

		if (poll(&wait, 1, SILENCE_MS) != 1) {
			fprintf(stderr, "silence after %u events\n", heard->count);
			rc = -1;
		} else {
			rc = touch_dispatch(touch);
		}
	}
	touch_destroy(touch);
	return rc;
}

static bool at(const struct touch_event *event, float x, float y)
{
	return fabsf(event->x_px - x) < 1.5f && fabsf(event->y_px - y) < 1.5f;
}

static int sees_two_fingers_part(void)
{
	const struct touch_options options = { .width_px = 1000, .height_px = 500 };
	struct heard heard = { 0 };

	EXPECT(listen_to(&heard, &options, 2) == 0);
	EXPECT(heard.count == 8);
	EXPECT(heard.events[0].phase == TOUCH_DOWN && at(&heard.events[0], 400, 250));
	EXPECT(heard.events[1].phase == TOUCH_DOWN && at(&heard.events[1], 600, 250));
	EXPECT(heard.events[0].contact != heard.events[1].contact);
	EXPECT(at(&heard.events[4], 300, 250) && at(&heard.events[5], 700, 250));
	EXPECT(heard.events[6].phase == TOUCH_UP);
	EXPECT(heard.events[6].contact == heard.events[0].contact);
	EXPECT(heard.events[0].time_us == 100100000); /* the kernel's, not ours */
	EXPECT(heard.events[6].time_us == 100170000);
	return 0;
}

/* The same fingers on a panel that hangs turned: a quarter clockwise, the panel's own left is the
 * visitor's top. */
static int follows_the_panels_turn(void)
{
	const struct touch_options options = { .width_px = 500,
					       .height_px = 1000,
					       .rotation_deg = 90 };
	struct heard heard = { 0 };

	EXPECT(listen_to(&heard, &options, 2) == 0);
	EXPECT(at(&heard.events[0], 250, 400) && at(&heard.events[1], 250, 600));
	return 0;
}

static int follows_calibration(void)
{
	const struct touch_options options = { .width_px = 1000,
					       .height_px = 500,
					       .matrix = { -1, 0, 1, 0, 0.5f, 0 } };
	struct heard heard = { 0 };

	EXPECT(listen_to(&heard, &options, 2) == 0);
	EXPECT(at(&heard.events[0], 600, 125) && at(&heard.events[1], 400, 125));
	return 0;
}

/* What udev's rules say of the device, as desktops take it too. */
static int follows_udevs_calibration(void)
{
	const struct touch_options options = { .width_px = 1000, .height_px = 500 };
	struct heard heard = { 0 };

	EXPECT(listen_to(&heard, &options, 2) == 0);
	EXPECT(at(&heard.events[0], 600, 125) && at(&heard.events[1], 400, 125));
	return 0;
}

static int the_profiles_calibration_wins(void)
{
	const struct touch_options options = { .width_px = 1000,
					       .height_px = 500,
					       .matrix = { 1, 0, 0, 0, 1, 0.25f } };
	struct heard heard = { 0 };

	EXPECT(listen_to(&heard, &options, 2) == 0);
	EXPECT(at(&heard.events[0], 400, 375) && at(&heard.events[1], 600, 375));
	return 0;
}

static int heals_what_was_lost_and_ignores_palms(void)
{
	const struct touch_options options = {
		.width_px = 1000, .height_px = 500, .edge_px = 8, .palm_px = 200
	};
	static const enum touch_phase expected[] = {
		TOUCH_DOWN, TOUCH_MOVE,   TOUCH_UP, /* the changed id */
		TOUCH_DOWN, TOUCH_CANCEL,           /* the finger that grew */
		TOUCH_DOWN, TOUCH_UP,               /* over the overflow */
		TOUCH_DOWN, TOUCH_UP,               /* after it */
	};
	struct heard heard = { 0 };

	EXPECT(listen_to(&heard, &options, 4) == 0);
	EXPECT(heard.count == ARRAY_COUNT(expected));
	for (uint32_t i = 0; i < heard.count; i++)
		EXPECT(heard.events[i].phase == expected[i]);
	EXPECT(at(&heard.events[1], 732.6f, 122.1f));
	EXPECT(at(&heard.events[7], 317.5f, 122.1f));
	return 0;
}

static int takes_a_tablet_for_one_finger(void)
{
	const struct touch_options options = { .width_px = 1000, .height_px = 500 };
	struct heard heard = { 0 };

	EXPECT(listen_to(&heard, &options, 1) == 0);
	EXPECT(heard.count == 3);
	EXPECT(heard.events[0].phase == TOUCH_DOWN && at(&heard.events[0], 250, 375));
	EXPECT(heard.events[1].phase == TOUCH_MOVE && at(&heard.events[1], 500, 375));
	EXPECT(heard.events[2].phase == TOUCH_UP && at(&heard.events[2], 500, 375));
	return 0;
}

/* The node appears while the kiosk runs, as when a cable is put in. */
static int takes_a_device_that_is_plugged_in_later(void)
{
	const struct touch_options options = { .width_px = 1000, .height_px = 500 };
	struct pollfd wait = { .events = POLLIN };
	const char *bed = getenv("UMOCKDEV_DIR");
	char node[256], aside[256];
	struct touch *touch;

	EXPECT(bed);
	snprintf(node, sizeof(node), "%s/dev/input/event5", bed);
	snprintf(aside, sizeof(aside), "%s/dev/unplugged", bed);
	EXPECT(rename(node, aside) == 0);
	EXPECT(touch_create(&touch, &options) == 0);
	EXPECT(touch_device_count(touch) == 0);
	EXPECT(rename(aside, node) == 0);
	wait.fd = touch_fd(touch);
	while (touch_device_count(touch) == 0) {
		EXPECT(poll(&wait, 1, SILENCE_MS) == 1);
		EXPECT(touch_dispatch(touch) == 0);
	}
	touch_destroy(touch);
	return 0;
}

static const struct {
	const char *name, *device, *events;
	int number;
	int (*run)(void);
} cases[] = {
	{ "sees_two_fingers_part", "panel", "panel-pinch", 5, sees_two_fingers_part },
	{ "follows_the_panels_turn", "panel", "panel-pinch", 5, follows_the_panels_turn },
	{ "follows_calibration", "panel", "panel-pinch", 5, follows_calibration },
	{ "follows_udevs_calibration", "panel-calibrated", "panel-pinch", 5,
	  follows_udevs_calibration },
	{ "the_profiles_calibration_wins", "panel-calibrated", "panel-pinch", 5,
	  the_profiles_calibration_wins },
	{ "goes_without_a_matrix_that_is_none", "panel-misread", "panel-pinch", 5,
	  sees_two_fingers_part },
	{ "heals_what_was_lost_and_ignores_palms", "panel", "panel-faults", 5,
	  heals_what_was_lost_and_ignores_palms },
	{ "takes_a_device_that_is_plugged_in_later", "panel", "panel-pinch", 5,
	  takes_a_device_that_is_plugged_in_later },
	{ "takes_a_tablet_for_one_finger", "tablet", "tablet-tap", 6,
	  takes_a_tablet_for_one_finger },
};

/* ---- above it ---- */

static const char *program;

static int run_beneath(size_t i)
{
	const int plain = (int)strcspn(cases[i].device, "-"); /* calibration is udev's alone */
	char command[1024];
	int status;

	snprintf(command, sizeof(command),
		 "umockdev-run -d tests/input/data/%s.umockdev"
		 " -i /dev/input/event%d=tests/input/data/%.*s.ioctl"
		 " -e /dev/input/event%d=tests/input/data/%s.events -- %s %s",
		 cases[i].device, cases[i].number, plain, cases[i].device, cases[i].number,
		 cases[i].events, program, cases[i].name);
	status = system(command);
	return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static void plays(void **state)
{
	size_t i = (size_t)*state;

	if (run_beneath(i) != 0)
		fail_msg("%s", cases[i].name);
}

int main(int argc, char **argv)
{
	struct CMUnitTest tests[ARRAY_COUNT(cases)];
	char options[256];

	for (size_t i = 0; argc > 1 && i < ARRAY_COUNT(cases); i++)
		if (strcmp(argv[1], cases[i].name) == 0)
			return cases[i].run();
	if (system("command -v umockdev-run >/dev/null") != 0) {
		puts("umockdev-run is not installed");
		return SKIPPED;
	}
	/* umockdev preloads itself before the sanitizer, which would refuse; and its own leaks are
	 * not ours to judge. */
	snprintf(options, sizeof(options), "%s:verify_asan_link_order=0:detect_leaks=0",
		 getenv("ASAN_OPTIONS") ? getenv("ASAN_OPTIONS") : "");
	setenv("ASAN_OPTIONS", options, 1);
	program = argv[0];
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++)
		tests[i] = (struct CMUnitTest){ .name = cases[i].name,
						.test_func = plays,
						.initial_state = (void *)i };
	return cmocka_run_group_tests(tests, NULL, NULL);
}
