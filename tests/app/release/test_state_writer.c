#include "app/release/state_writer.h"

#include <poll.h>
#include <semaphore.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "tests/check.h"

static char folder[64], path[96];
static sem_t gate;
static atomic_bool gated;

/* In place of the C library's: a disk that takes as long as the test likes. */
int fsync(int fd)
{
	if (gated)
		sem_wait(&gate);
	return (int)syscall(SYS_fsync, fd);
}

static int enter_empty_folder(void **unused)
{
	(void)unused;
	gated = false;
	sem_init(&gate, 0, 0);
	snprintf(folder, sizeof(folder), "/tmp/gopura-keeper-XXXXXX");
	CHECK(mkdtemp(folder));
	snprintf(path, sizeof(path), "%s/state.db", folder);
	return 0;
}

static int leave_folder(void **unused)
{
	char command[128];

	(void)unused;
	sem_destroy(&gate);
	snprintf(command, sizeof(command), "rm -rf %s", folder);
	return system(command);
}

static struct keeper *open_keeper(void)
{
	struct state *state;
	struct keeper *keeper;

	CHECK(state_create(&state, path) == 0);
	CHECK(keeper_create(&keeper, state) == 0);
	return keeper;
}

static void activate(struct keeper *keeper, uint8_t n)
{
	const uint8_t file[3] = { n, n, n };
	const struct state_release release = { { { n } }, 100u + n, n, { file, sizeof(file) } };

	CHECK(keeper_activate(keeper, &release) == 0);
}

static void wait_for_answer(struct keeper *keeper, struct keeper_answer *answer)
{
	struct pollfd ready = { .fd = keeper_fd(keeper), .events = POLLIN };

	CHECK(poll(&ready, 1, 60000) == 1);
	CHECK(keeper_take(keeper, answer));
}

static void asks_while_the_disk_sleeps(void **unused)
{
	struct keeper *keeper = open_keeper();
	struct keeper_answer answer;

	(void)unused;
	gated = true;
	activate(keeper, 7); /* would hang here, if it waited */
	CHECK(!keeper_take(keeper, &answer));
	gated = false;
	for (int i = 0; i < 8; i++)
		sem_post(&gate);
	wait_for_answer(keeper, &answer);
	CHECK(answer.rc == 0 && answer.sequence == 7 && answer.root.bytes[0] == 7);
	CHECK(!keeper_take(keeper, &answer));
	keeper_destroy(keeper);
}

static void writes_what_was_asked_for_before_it_ends(void **unused)
{
	const uint8_t trust[2] = { 1, 2 };
	struct keeper *keeper = open_keeper();
	struct state_release release;
	struct state *state;
	struct bytes file;

	(void)unused;
	activate(keeper, 3);
	CHECK(keeper_set_trust(keeper, (struct bytes){ trust, sizeof(trust) },
			       STATE_CLEAR_NOTHING) == 0);
	keeper_raise_time_floor(keeper, 2000000000);
	activate(keeper, 4);
	keeper_destroy(keeper);
	CHECK(state_create(&state, path) == 0);
	CHECK(state_release(state, &release) == 0);
	CHECK(release.sequence == 4 && release.root_bytes == 104 && release.file.size == 3);
	CHECK(state_trust(state, &file) == 0 && file.size == 2 && file.data[1] == 2);
	CHECK(state_time_floor_s(state) == 2000000000);
	state_destroy(state);
}

static void tells_of_a_release_that_is_too_old(void **unused)
{
	struct keeper *keeper = open_keeper();
	struct keeper_answer answer;

	(void)unused;
	activate(keeper, 9);
	wait_for_answer(keeper, &answer);
	activate(keeper, 8);
	wait_for_answer(keeper, &answer);
	CHECK(answer.rc < 0 && answer.sequence == 8);
	keeper_destroy(keeper);
}

static void tells_of_a_disk_that_cannot_be_written(void **unused)
{
	struct keeper *keeper;
	struct keeper_answer answer;

	(void)unused;
	snprintf(path, sizeof(path), "%s/no/such/folder/state.db", folder);
	keeper = open_keeper();
	activate(keeper, 1);
	wait_for_answer(keeper, &answer);
	CHECK(answer.rc < 0 && answer.sequence == 1);
	keeper_destroy(keeper);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(asks_while_the_disk_sleeps, enter_empty_folder,
						leave_folder),
		cmocka_unit_test_setup_teardown(writes_what_was_asked_for_before_it_ends,
						enter_empty_folder, leave_folder),
		cmocka_unit_test_setup_teardown(tells_of_a_release_that_is_too_old,
						enter_empty_folder, leave_folder),
		cmocka_unit_test_setup_teardown(tells_of_a_disk_that_cannot_be_written,
						enter_empty_folder, leave_folder),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
