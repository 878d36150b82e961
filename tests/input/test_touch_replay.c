/* Replay files: what they say, what is wrong with them, and that they play in their time. */
#include "input/touch_replay.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "input/touch.h"
#include "tests/check.h"

static int parse(struct touch_replay *out, const char *text, unsigned *line)
{
	return touch_replay_parse(out, (struct bytes){ (const uint8_t *)text, strlen(text) }, 1280,
				  720, line);
}

static void reads_what_it_says(void **state)
{
	struct touch_replay replay;

	(void)state;
	CHECK(parse(&replay,
		    "# a tap, then two fingers\n\nsize 640 360\n0 down 0 100 50\n"
		    "80.5 up 0   # where it came down\n200 down 1 10 10\r\n210 down 0 20 20\n"
		    "220 move 1 12 10\n230 cancel 1\n240 up 0 30 30",
		    NULL) == 0);
	CHECK(replay.count == 7);
	CHECK(replay.events[0].phase == TOUCH_DOWN && replay.events[0].x_px == 200);
	CHECK(replay.events[1].phase == TOUCH_UP && replay.events[1].time_us == 80500);
	CHECK(replay.events[1].y_px == 100);
	CHECK(replay.events[4].contact == 1 && replay.events[4].x_px == 24);
	CHECK(replay.events[5].phase == TOUCH_CANCEL && replay.events[5].x_px == 24);
	touch_replay_finish(&replay);
	touch_replay_finish(NULL);
	CHECK(parse(&replay, "", NULL) == 0 && replay.count == 0);
}

static void names_the_line_of_a_fault(void **state)
{
	static const struct {
		const char *text;
		unsigned line;
	} cases[] = {
		{ "0 down 0 1 1\n5 press 0 1 1\n", 2 },
		{ "0 down 0 1\n", 1 },
		{ "0 down 10 1 1\n", 1 },
		{ "0 down -1 1 1\n", 1 },
		{ "0 move 0 1 1\n", 1 },
		{ "0 up 0\n", 1 },
		{ "0 down 0 1 1\n1 down 0 1 1\n", 2 },
		{ "9 down 0 1 1\n8 up 0\n", 2 },
		{ "0 down 0 1 1 1\n", 1 },
		{ "0 down 0 nan 1\n", 1 },
		{ "-1 down 0 1 1\n", 1 },
		{ "\n\nhello\n", 3 },
		{ "0 down 0 1 1\nsize 1 1\n", 2 },
		{ "size 0 0\n", 1 },
	};
	char longest[1000];
	struct touch_replay replay;
	unsigned line;

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		int rc = parse(&replay, cases[i].text, &line);

		if (rc != -EINVAL || line != cases[i].line)
			fail_msg("case %zu: %d at line %u", i, rc, line);
		CHECK(!replay.events && replay.count == 0);
	}
	memset(longest, ' ', sizeof(longest) - 1);
	longest[sizeof(longest) - 1] = 0;
	CHECK(parse(&replay, longest, &line) == -EINVAL);
}

struct played {
	struct touch_event events[8];
	uint32_t count;
};

static void note(void *data, const struct touch_event *event)
{
	struct played *played = data;

	if (played->count < 8)
		played->events[played->count++] = *event;
}

static void plays_through_one_fd(void **state)
{
	static const char text[] = "0 down 0 10 20\n10 move 0 30 20\n40 up 0\n";
	char path[] = "/tmp/gopura-replay-XXXXXX";
	struct played played = { 0 };
	struct touch_options options = { .width_px = 100,
					 .height_px = 100,
					 .event = note,
					 .data = &played,
					 .replay_path = path };
	struct touch *touch;
	int fd = mkstemp(path);

	(void)state;
	CHECK(fd >= 0 && write(fd, text, strlen(text)) == (ssize_t)strlen(text));
	close(fd);
	CHECK(touch_create(&touch, &options) == 0);
	CHECK(touch_device_count(touch) == 0);
	while (!touch_replay_ended(touch)) {
		struct pollfd wait = { .fd = touch_fd(touch), .events = POLLIN };

		CHECK(poll(&wait, 1, 5000) == 1); /* else it would never have come */
		CHECK(touch_waits(touch));
		CHECK(touch_dispatch(touch) == 0);
	}
	CHECK(played.count == 3 && played.events[2].phase == TOUCH_UP);
	CHECK(played.events[2].x_px == 30 && played.events[2].time_us == 40000);
	touch_destroy(touch);
	touch_destroy(NULL);
	CHECK(truncate(path, 5) == 0);
	CHECK(touch_create(&touch, &options) == -EINVAL && !touch);
	unlink(path);
	CHECK(touch_create(&touch, &options) == -ENOENT);
}

/* Nothing there, then files that are no devices: no device, no fault, and it still listens. */
static void waits_for_devices_that_may_come(void **state)
{
	char folder[] = "/tmp/gopura-input-XXXXXX", path[100];
	struct touch_options options = { .width_px = 100, .height_px = 100, .folder = folder };
	struct pollfd wait = { .events = POLLIN };
	struct touch *touch;
	int fd;

	(void)state;
	CHECK(mkdtemp(folder));
	CHECK(touch_create(&touch, &options) == 0);
	wait.fd = touch_fd(touch);
	CHECK(poll(&wait, 1, 0) == 0 && !touch_waits(touch) && !touch_waits(NULL));
	snprintf(path, sizeof(path), "%s/event3", folder);
	fd = open(path, O_CREAT | O_WRONLY, 0600);
	CHECK(fd >= 0);
	close(fd);
	CHECK(poll(&wait, 1, 5000) == 1); /* heard of it */
	CHECK(touch_dispatch(touch) == 0);
	CHECK(touch_device_count(touch) == 0 && !touch_replay_ended(touch));
	CHECK(poll(&wait, 1, 0) == 0);
	touch_destroy(touch);
	unlink(path);
	rmdir(folder);
	/* The folder itself may come later. */
	CHECK(touch_create(&touch, &options) == 0);
	wait.fd = touch_fd(touch);
	CHECK(mkdir(folder, 0700) == 0);
	CHECK(poll(&wait, 1, 5000) == 1 && touch_dispatch(touch) == 0);
	while (poll(&wait, 1, 0) == 1)
		CHECK(touch_dispatch(touch) == 0);
	fd = open(path, O_CREAT | O_WRONLY, 0600);
	CHECK(fd >= 0);
	close(fd);
	CHECK(poll(&wait, 1, 5000) == 1);
	touch_destroy(touch);
	unlink(path);
	rmdir(folder);
}

/* Takes in what was heard, and checks that this ends. */
static void take_in(struct touch *touch)
{
	struct pollfd wait = { .fd = touch_fd(touch), .events = POLLIN };

	for (int i = 0; poll(&wait, 1, 0) == 1; i++)
		CHECK(i < 20 && touch_dispatch(touch) == 0);
}

/* As the kernel does when the last device is unplugged and one is plugged in again. */
static void listens_again_after_the_folder_was_removed(void **state)
{
	char dev[] = "/tmp/gopura-input-XXXXXX", folder[100], path[120];
	struct touch_options options = { .width_px = 100, .height_px = 100, .folder = folder };
	struct pollfd wait = { .events = POLLIN };
	struct touch *touch;

	(void)state;
	CHECK(mkdtemp(dev));
	snprintf(folder, sizeof(folder), "%s/input", dev);
	CHECK(mkdir(folder, 0700) == 0 && touch_create(&touch, &options) == 0);
	wait.fd = touch_fd(touch);
	snprintf(path, sizeof(path), "%s/event3", folder);
	for (int round = 0; round < 6; round++) {
		int fd;

		CHECK(rmdir(folder) == 0);
		if (round % 2)
			take_in(touch);
		CHECK(mkdir(folder, 0700) == 0);
		take_in(touch);
		fd = open(path, O_CREAT | O_WRONLY, 0600);
		CHECK(fd >= 0);
		close(fd);
		CHECK(poll(&wait, 1, 5000) == 1);
		CHECK(unlink(path) == 0);
		take_in(touch);
	}
	touch_destroy(touch);
	rmdir(folder);
	rmdir(dev);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(reads_what_it_says),
		cmocka_unit_test(names_the_line_of_a_fault),
		cmocka_unit_test(plays_through_one_fd),
		cmocka_unit_test(waits_for_devices_that_may_come),
		cmocka_unit_test(listens_again_after_the_folder_was_removed),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
