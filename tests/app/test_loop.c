/* Turns of the event loop: real descriptors, and tasks that write down when they had their turn. */
#include "app/loop.h"

#include <errno.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "tests/check.h"

static struct loop loop;
static char order[64]; /* a letter for each call */
static int wait_ms, quit_after, rc_of_b, rc_of_source;

static void note(char letter)
{
	const size_t length = strlen(order);

	if (length + 1 < sizeof(order))
		order[length] = letter;
	if (quit_after > 0 && --quit_after == 0)
		loop_quit(&loop);
}

static int on_source(void *data)
{
	eventfd_t value;

	CHECK(eventfd_read(*(int *)data, &value) == 0);
	note('s');
	return rc_of_source;
}

static int turn_a(void *data)
{
	(void)data;
	note('a');
	return 0;
}

static int turn_b(void *data)
{
	CHECK(data == &loop);
	note('b');
	return rc_of_b;
}

static int wait_of_b(void *data)
{
	CHECK(data == &loop);
	return wait_ms;
}

static int fd;

static int set_up(void **state)
{
	(void)state;
	memset(order, 0, sizeof(order));
	wait_ms = quit_after = rc_of_b = rc_of_source = 0;
	fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	const struct loop_source sources[] = { { "absent", -1, on_source, NULL },
					       { "event", fd, on_source, &fd } };
	const struct loop_task tasks[] = { { "a", NULL, turn_a, NULL },
					   { "b", wait_of_b, turn_b, &loop } };

	return loop_init(&loop, sources, ARRAY_COUNT(sources), tasks, ARRAY_COUNT(tasks));
}

static int tear_down(void **state)
{
	(void)state;
	loop_finish(&loop);
	loop_finish(&loop); /* once more does no harm */
	close(fd);
	return 0;
}

static void every_task_has_its_turn_in_order(void **state)
{
	(void)state;
	quit_after = 4;
	CHECK(loop_run(&loop) == 0);
	CHECK(strcmp(order, "abab") == 0 && !loop.failed);
}

static void what_is_readable_comes_before_the_tasks(void **state)
{
	(void)state;
	CHECK(eventfd_write(fd, 1) == 0);
	wait_ms = -1; /* only the source ends the wait */
	quit_after = 3;
	CHECK(loop_run(&loop) == 0);
	CHECK(strcmp(order, "sab") == 0);
}

static void a_deadline_ends_the_wait(void **state)
{
	(void)state;
	wait_ms = 5;
	quit_after = 2;
	CHECK(loop_run(&loop) == 0);
	CHECK(strcmp(order, "ab") == 0);
}

static void nothing_is_called_after_it_was_told_to_quit(void **state)
{
	(void)state;
	CHECK(eventfd_write(fd, 1) == 0);
	quit_after = 1;
	CHECK(loop_run(&loop) == 0);
	CHECK(strcmp(order, "s") == 0);
	CHECK(loop_run(&loop) == 0 && strcmp(order, "s") == 0);
}

static void ends_with_what_failed_and_its_name(void **state)
{
	(void)state;
	rc_of_b = -EIO;
	CHECK(loop_run(&loop) == -EIO);
	CHECK(strcmp(order, "ab") == 0 && strcmp(loop.failed, "b") == 0);
	rc_of_source = -ENODEV;
	CHECK(eventfd_write(fd, 1) == 0);
	CHECK(loop_run(&loop) == -ENODEV);
	CHECK(strcmp(order, "abs") == 0 && strcmp(loop.failed, "event") == 0);
}

int main(void)
{
#define CASE(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
	const struct CMUnitTest tests[] = {
		CASE(every_task_has_its_turn_in_order),
		CASE(what_is_readable_comes_before_the_tasks),
		CASE(a_deadline_ends_the_wait),
		CASE(nothing_is_called_after_it_was_told_to_quit),
		CASE(ends_with_what_failed_and_its_name),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
