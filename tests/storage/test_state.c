#include "storage/state.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "tests/check.h"
#include "tests/storage/fault_vfs.h"

static char folder[64], path[96];

static int enter_empty_folder(void **unused)
{
	(void)unused;
	fault_set(FAULT_NONE, 0, 0);
	snprintf(folder, sizeof(folder), "/tmp/gopura-state-XXXXXX");
	CHECK(mkdtemp(folder));
	snprintf(path, sizeof(path), "%s/state.db", folder);
	return 0;
}

static int leave_folder(void **unused)
{
	char command[128];

	(void)unused;
	snprintf(command, sizeof(command), "rm -rf %s", folder);
	return system(command);
}

static struct state *open_state(void)
{
	struct state *state;

	CHECK(state_create(&state, path) == 0);
	return state;
}

/* Release n of the test: everything about it follows from n. */
static struct state_release release(uint8_t n)
{
	static uint8_t files[256][32];

	memset(files[n], n, sizeof(files[n]));
	return (struct state_release){ { { n } }, 1000u + n, n, { files[n], 32 } };
}

static int activate(struct state *state, uint8_t n)
{
	struct state_release next = release(n);

	return state_activate(state, &next);
}

/* The number of the release in use, each of its fields checked; 0: none. */
static int active(const struct state *state)
{
	struct state_release now, expected;

	if (state_release(state, &now) == -ENOENT)
		return 0;
	expected = release((uint8_t)now.sequence);
	CHECK(hash_equal(now.root, expected.root) && now.root_bytes == expected.root_bytes);
	CHECK(now.file.size == 32 && memcmp(now.file.data, expected.file.data, 32) == 0);
	return (int)now.sequence;
}

static void write_at(const char *suffix, long at, const char *bytes)
{
	char name[128];
	FILE *file;

	snprintf(name, sizeof(name), "%s%s", path, suffix);
	file = fopen(name, "r+b");
	CHECK(file && fseek(file, at, SEEK_SET) == 0);
	CHECK(fputs(bytes, file) >= 0 && fclose(file) == 0);
}

static bool exists(const char *suffix)
{
	char name[128];

	snprintf(name, sizeof(name), "%s%s", path, suffix);
	return access(name, F_OK) == 0;
}

static void remembers_across_a_restart(void **unused)
{
	struct state *state = open_state();
	struct bytes trust;

	(void)unused;
	CHECK(active(state) == 0 && state_sequence_floor(state) == 0);
	CHECK(state_trust(state, &trust) == -ENOENT);
	CHECK(state_set_trust(state, (struct bytes){ (const uint8_t *)"root", 4 }) == 0);
	CHECK(activate(state, 3) == 0);
	CHECK(state_raise_time_floor(state, 1700000000) == 0);
	state_destroy(state);
	state = open_state();
	CHECK(active(state) == 3 && state_sequence_floor(state) == 3);
	CHECK(state_time_floor_s(state) == 1700000000);
	CHECK(state_trust(state, &trust) == 0 && trust.size == 4);
	CHECK(memcmp(trust.data, "root", 4) == 0);
	state_destroy(state);
	state_destroy(NULL);
}

static void cleans_up_what_a_cut_left_of_the_second_copy(void **unused)
{
	struct state *state = open_state();
	char name[128];
	FILE *file;

	(void)unused;
	CHECK(activate(state, 3) == 0);
	state_destroy(state);
	snprintf(name, sizeof(name), "%s.second.x1Y2z3", path);
	file = fopen(name, "w");
	CHECK(file && fputs("half a rec", file) >= 0 && fclose(file) == 0);
	state = open_state();
	CHECK(!exists(".second.x1Y2z3") && exists(".second") && active(state) == 3);
	state_destroy(state);
}

static void never_lowers_a_floor(void **unused)
{
	struct state *state = open_state();

	(void)unused;
	CHECK(activate(state, 5) == 0);
	CHECK(activate(state, 4) == -ESTALE);
	CHECK(active(state) == 5);
	CHECK(activate(state, 5) == 0); /* the same again is fine */
	CHECK(state_raise_time_floor(state, 100000) == 0);
	CHECK(state_raise_time_floor(state, 50000) == 0);
	CHECK(state_time_floor_s(state) == 100000);
	state_destroy(state);
}

static void refuses_a_file_past_its_ceiling(void **unused)
{
	struct state *state = open_state();
	uint8_t *large = calloc(1, STATE_FILE_BYTES_MOST + 1);
	struct state_release next = release(9);

	(void)unused;
	CHECK(activate(state, 1) == 0);
	next.file = (struct bytes){ large, STATE_FILE_BYTES_MOST + 1 };
	CHECK(state_activate(state, &next) == -EFBIG);
	CHECK(state_set_trust(state, next.file) == -EFBIG);
	CHECK(active(state) == 1 && state_sequence_floor(state) == 1);
	free(large);
	state_destroy(state);
}

static void comes_back_from_the_second_copy(void **unused)
{
	struct state *state = open_state();

	(void)unused;
	CHECK(activate(state, 7) == 0);
	state_destroy(state);
	write_at("", 0, "no database");
	state = open_state();
	CHECK(exists(".broken"));
	CHECK(active(state) == 7 && state_sequence_floor(state) == 7);
	CHECK(activate(state, 8) == 0);
	state_destroy(state);
	state = open_state();
	CHECK(active(state) == 8);
	state_destroy(state);
}

static void begins_anew_when_both_copies_are_damaged(void **unused)
{
	struct state *state = open_state();

	(void)unused;
	CHECK(activate(state, 7) == 0);
	state_destroy(state);
	write_at("", 0, "no database");
	write_at(".second", 20, "x");
	state = open_state();
	CHECK(active(state) == 0);
	CHECK(activate(state, 1) == 0 && active(state) == 1);
	state_destroy(state);
}

static void keeps_the_floor_when_an_old_database_is_put_back(void **unused)
{
	struct state *state = open_state();
	struct buffer old;

	(void)unused;
	buffer_init(&old, 1 << 20);
	CHECK(activate(state, 3) == 0);
	state_destroy(state);
	CHECK(buffer_read_file(&old, path) == 0);
	state = open_state();
	CHECK(activate(state, 6) == 0);
	state_destroy(state);
	CHECK(bytes_write_file(buffer_bytes(&old), path) == 0);
	state = open_state();
	CHECK(state_sequence_floor(state) == 6);
	CHECK(activate(state, 5) == -ESTALE);
	buffer_finish(&old);
	state_destroy(state);
}

static void survives_a_database_cut_anywhere(void **unused)
{
	struct state *state = open_state();
	struct buffer whole;

	(void)unused;
	buffer_init(&whole, 1 << 20);
	CHECK(activate(state, 7) == 0);
	state_destroy(state);
	CHECK(buffer_read_file(&whole, path) == 0);
	for (size_t n = 0; n < whole.size; n += 97) {
		CHECK(bytes_write_file((struct bytes){ whole.data, n }, path) == 0);
		state = open_state();
		CHECK(active(state) == 7);
		state_destroy(state);
	}
	for (size_t n = 0; n < whole.size; n += 61) {
		whole.data[n] ^= 0x10;
		CHECK(bytes_write_file(buffer_bytes(&whole), path) == 0);
		whole.data[n] ^= 0x10;
		state = open_state();
		CHECK(active(state) == 7);
		state_destroy(state);
	}
	buffer_finish(&whole);
}

/* The number of the release that could be returned to; 0: none. */
static int previous(const struct state *state)
{
	struct state_release before;

	return state_previous(state, &before) == 0 ? (int)before.sequence : 0;
}

static void keeps_the_last_release_that_worked(void **unused)
{
	struct state *state = open_state();

	(void)unused;
	CHECK(activate(state, 1) == 0);
	CHECK(state_tries(state) == 1 && previous(state) == 0);
	CHECK(state_fall_back(state) == -ENOENT);
	CHECK(state_try(state) == 0 && state_tries(state) == 1); /* there is no other */
	CHECK(state_prove(state) == 0 && state_tries(state) == 0);
	CHECK(activate(state, 2) == 0 && previous(state) == 1);
	CHECK(activate(state, 3) == 0 && previous(state) == 1); /* 2 was never seen to work */
	CHECK(state_try(state) == 0);
	state_destroy(state);
	state = open_state();
	CHECK(active(state) == 3 && previous(state) == 1 && state_tries(state) == 2);
	CHECK(state_prove(state) == 0 && previous(state) == 1);
	CHECK(activate(state, 4) == 0 && previous(state) == 3);
	state_destroy(state);
}

static void falls_back_without_lowering_the_floor(void **unused)
{
	struct state *state = open_state();

	(void)unused;
	CHECK(activate(state, 1) == 0 && state_prove(state) == 0 && activate(state, 2) == 0);
	CHECK(state_fall_back(state) == 0);
	for (int i = 0; i < 2; i++) {
		CHECK(active(state) == 1 && previous(state) == 0 && state_tries(state) == 0);
		CHECK(state_sequence_floor(state) == 2);
		CHECK(activate(state, 1) == -ESTALE); /* nobody may offer it again */
		state_destroy(state);
		state = open_state();
	}
	CHECK(activate(state, 3) == 0 && previous(state) == 1);
	state_destroy(state);
}

static void signs_the_same_root_anew_without_a_trial(void **unused)
{
	struct state_release again = release(1);
	struct state *state = open_state();

	(void)unused;
	CHECK(activate(state, 1) == 0 && state_prove(state) == 0);
	again.sequence = 9;
	CHECK(state_activate(state, &again) == 0);
	CHECK(state_tries(state) == 0 && previous(state) == 0);
	state_destroy(state);
}

/* Power goes at every write in turn: afterwards it is the old release or the new one, whole. */
static void is_old_or_new_after_a_power_cut_anywhere(void **unused)
{
	int olds = 0, news = 0;
	char command[128];

	(void)unused;
	snprintf(command, sizeof(command), "rm -f %s*", path);
	for (long at = 0; at < 40; at++) {
		struct state *state;
		int rc, now;

		CHECK(system(command) == 0);
		state = open_state();
		CHECK(activate(state, 1) == 0);
		state_destroy(state);
		state = open_state();
		fault_set(FAULT_POWER_CUT, at, 0);
		rc = activate(state, 2);
		state_destroy(state);
		fault_set(FAULT_NONE, 0, 0);
		state = open_state();
		now = active(state);
		CHECK(now == 1 || now == 2);
		CHECK(rc < 0 || now == 2); /* what was promised stays */
		CHECK(state_sequence_floor(state) == (uint64_t)now);
		olds += now == 1;
		news += now == 2;
		CHECK(activate(state, 3) == 0);
		state_destroy(state);
		CHECK(!exists(".broken"));
	}
	CHECK(olds > 0 && news > 0);
}

static void refuses_changes_on_a_full_disk_and_goes_on(void **unused)
{
	struct state *state = open_state();

	(void)unused;
	CHECK(activate(state, 1) == 0);
	fault_set(FAULT_FULL, 0, 0);
	CHECK(activate(state, 2) == -ENOSPC);
	CHECK(active(state) == 1);
	fault_set(FAULT_NONE, 0, 0);
	CHECK(activate(state, 2) == 0 && active(state) == 2);
	state_destroy(state);
}

static void lives_without_a_disk(void **unused)
{
	struct state *state;

	(void)unused;
	CHECK(state_create(&state, "/nonexistent/state.db") == 0);
	CHECK(active(state) == 0);
	CHECK(activate(state, 1) == -EIO);
	state_destroy(state);
}

#define IN_A_FOLDER(test) cmocka_unit_test_setup_teardown(test, enter_empty_folder, leave_folder)

int main(void)
{
	const struct CMUnitTest tests[] = {
		IN_A_FOLDER(remembers_across_a_restart),
		IN_A_FOLDER(cleans_up_what_a_cut_left_of_the_second_copy),
		IN_A_FOLDER(never_lowers_a_floor),
		IN_A_FOLDER(refuses_a_file_past_its_ceiling),
		IN_A_FOLDER(comes_back_from_the_second_copy),
		IN_A_FOLDER(begins_anew_when_both_copies_are_damaged),
		IN_A_FOLDER(keeps_the_floor_when_an_old_database_is_put_back),
		IN_A_FOLDER(survives_a_database_cut_anywhere),
		IN_A_FOLDER(keeps_the_last_release_that_worked),
		IN_A_FOLDER(falls_back_without_lowering_the_floor),
		IN_A_FOLDER(signs_the_same_root_anew_without_a_trial),
		IN_A_FOLDER(is_old_or_new_after_a_power_cut_anywhere),
		IN_A_FOLDER(refuses_changes_on_a_full_disk_and_goes_on),
		IN_A_FOLDER(lives_without_a_disk),
	};

	fault_install();
	return cmocka_run_group_tests(tests, NULL, NULL);
}
