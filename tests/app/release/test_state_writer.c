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

static struct state_writer *open_keeper(void)
{
	struct state *state;
	struct state_writer *writer;

	CHECK(state_create(&state, path) == 0);
	CHECK(state_writer_create(&writer, state) == 0);
	return writer;
}

static void activate(struct state_writer *writer, uint8_t n)
{
	const uint8_t file[3] = { n, n, n };
	const struct state_release release = { { { n } }, 100u + n, n, { file, sizeof(file) } };

	CHECK(state_writer_activate(writer, &release) == 0);
}

static void wait_for_answer(struct state_writer *writer, struct state_writer_answer *answer)
{
	struct pollfd ready = { .fd = state_writer_fd(writer), .events = POLLIN };

	CHECK(poll(&ready, 1, 60000) == 1);
	CHECK(state_writer_take(writer, answer));
}

static void asks_while_the_disk_sleeps(void **unused)
{
	struct state_writer *writer = open_keeper();
	struct state_writer_answer answer;

	(void)unused;
	gated = true;
	activate(writer, 7); /* would hang here, if it waited */
	CHECK(!state_writer_take(writer, &answer));
	gated = false;
	for (int i = 0; i < 8; i++)
		sem_post(&gate);
	wait_for_answer(writer, &answer);
	CHECK(answer.rc == 0 && answer.sequence == 7 && answer.root.bytes[0] == 7);
	CHECK(!state_writer_take(writer, &answer));
	state_writer_destroy(writer);
}

static void writes_what_was_asked_for_before_it_ends(void **unused)
{
	const uint8_t trust[2] = { 1, 2 };
	struct state_writer *writer = open_keeper();
	struct state_release release;
	struct state *state;
	struct bytes file;

	(void)unused;
	activate(writer, 3);
	CHECK(state_writer_set_trust(writer, (struct bytes){ trust, sizeof(trust) },
				     STATE_CLEAR_NOTHING) == 0);
	state_writer_raise_time_floor(writer, 2000000000);
	activate(writer, 4);
	state_writer_destroy(writer);
	CHECK(state_create(&state, path) == 0);
	CHECK(state_release(state, &release) == 0);
	CHECK(release.sequence == 4 && release.root_bytes == 104 && release.file.size == 3);
	CHECK(state_trust(state, &file) == 0 && file.size == 2 && file.data[1] == 2);
	CHECK(state_time_floor_s(state) == 2000000000);
	state_destroy(state);
}

/* What was asked for later replaces what waits, but not the floors that it clears. */
static void writes_the_last_of_the_trusted_metadata(void **unused)
{
	static const uint8_t one[] = "one", two[] = "two";
	const struct state_tuf first = { { one, 3 }, { one, 2 }, { NULL, 0 }, { NULL, 0 } };
	const struct state_tuf second = { { two, 3 }, { two, 2 }, { two, 1 }, { two, 3 } };
	struct state_writer *writer = open_keeper();
	struct state_writer_answer answer;
	struct state_tuf kept;
	struct state *state;

	(void)unused;
	activate(writer, 9);
	wait_for_answer(writer, &answer);
	gated = true;
	state_writer_prove(writer); /* the thread waits for the disk */
	CHECK(state_writer_set_tuf(writer, &first, STATE_CLEAR_SEQUENCE_FLOOR) == 0);
	CHECK(state_writer_set_tuf(writer, &second, STATE_CLEAR_NOTHING) == 0);
	gated = false;
	for (int i = 0; i < 32; i++)
		sem_post(&gate);
	state_writer_destroy(writer);
	CHECK(state_create(&state, path) == 0);
	CHECK(state_tuf(state, &kept) == 0);
	CHECK(bytes_equal(kept.root, second.root) && bytes_equal(kept.timestamp, second.timestamp));
	CHECK(bytes_equal(kept.snapshot, second.snapshot) &&
	      bytes_equal(kept.targets, second.targets));
	CHECK(state_sequence_floor(state) == 0);
	state_destroy(state);
}

static void tells_of_a_release_that_is_too_old(void **unused)
{
	struct state_writer *writer = open_keeper();
	struct state_writer_answer answer;

	(void)unused;
	activate(writer, 9);
	wait_for_answer(writer, &answer);
	activate(writer, 8);
	wait_for_answer(writer, &answer);
	CHECK(answer.rc < 0 && answer.sequence == 8);
	state_writer_destroy(writer);
}

static void tells_of_a_disk_that_cannot_be_written(void **unused)
{
	struct state_writer *writer;
	struct state_writer_answer answer;

	(void)unused;
	snprintf(path, sizeof(path), "%s/no/such/folder/state.db", folder);
	writer = open_keeper();
	activate(writer, 1);
	wait_for_answer(writer, &answer);
	CHECK(answer.rc < 0 && answer.sequence == 1);
	state_writer_destroy(writer);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(asks_while_the_disk_sleeps, enter_empty_folder,
						leave_folder),
		cmocka_unit_test_setup_teardown(writes_what_was_asked_for_before_it_ends,
						enter_empty_folder, leave_folder),
		cmocka_unit_test_setup_teardown(writes_the_last_of_the_trusted_metadata,
						enter_empty_folder, leave_folder),
		cmocka_unit_test_setup_teardown(tells_of_a_release_that_is_too_old,
						enter_empty_folder, leave_folder),
		cmocka_unit_test_setup_teardown(tells_of_a_disk_that_cannot_be_written,
						enter_empty_folder, leave_folder),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
