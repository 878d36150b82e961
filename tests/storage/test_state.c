#include "format/metadata_sign.h"
#include "storage/state.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <sodium.h>

#include "format/metadata.h"
#include "storage/db.h"
#include "storage/state_record.h"
#include "tests/check.h"
#include "tests/storage/fault_vfs.h"

static char folder[64], path[96];

/* Of calls of our own code: the second copy cannot be opened so often, and one allocation fails. */
static int seconds_that_fail;
static long allocations, allocation_that_fails = -1;

int __real_open(const char *name, int flags, ...);
int __wrap_open(const char *name, int flags, ...);
void *__real_realloc(void *at, size_t size);
void *__wrap_realloc(void *at, size_t size);

int __wrap_open(const char *name, int flags, ...)
{
	if (seconds_that_fail > 0 && strstr(name, ".second")) {
		seconds_that_fail--;
		errno = EIO;
		return -1;
	}
	return __real_open(name, flags);
}

void *__wrap_realloc(void *at, size_t size)
{
	return allocations++ == allocation_that_fails ? NULL : __real_realloc(at, size);
}

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
	CHECK(state_set_trust(state, (struct bytes){ (const uint8_t *)"root", 4 },
			      STATE_CLEAR_NOTHING) == 0);
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
	uint8_t *large = calloc(1, STATE_FILE_BYTES_MAX + 1);
	struct state_release next = release(9);

	(void)unused;
	CHECK(activate(state, 1) == 0);
	next.file = (struct bytes){ large, STATE_FILE_BYTES_MAX + 1 };
	CHECK(state_activate(state, &next) == -EFBIG);
	CHECK(state_set_trust(state, next.file, STATE_CLEAR_NOTHING) == -EFBIG);
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

/* SQLite calls a page damaged whose read the system refused. */
static void a_read_that_fails_is_no_damage(void **unused)
{
	struct state *state = open_state();
	bool was_hit = true;

	(void)unused;
	CHECK(activate(state, 1) == 0);
	state_destroy(state);
	for (uint8_t at = 0; was_hit; at++) {
		fault_set(FAULT_READ, at, 1);
		state = open_state();
		was_hit = fault.reads > at;
		fault_set(FAULT_NONE, 0, 0);
		CHECK(!exists(".broken") && active(state) == at + 1);
		CHECK(activate(state, (uint8_t)(at + 2)) == 0);
		state_destroy(state);
		CHECK(!was_hit || at < 200);
	}
	state = open_state();
	const int last = active(state);
	state_destroy(state);
	fault_set(FAULT_READ, 0, 1000000); /* as long as it runs */
	state = open_state();
	CHECK(active(state) == last); /* of the second copy */
	CHECK(activate(state, 250) == -EIO);
	state_destroy(state);
	fault_set(FAULT_NONE, 0, 0);
	state = open_state();
	CHECK(!exists(".broken") && active(state) == last && activate(state, 250) == 0);
	state_destroy(state);
}

static void a_lack_of_memory_is_no_damage(void **unused)
{
	struct state *state = open_state();

	(void)unused;
	CHECK(activate(state, 7) == 0);
	state_destroy(state);
	allocations = 0;
	for (long at = 0; at <= allocations; at++) {
		int rc;

		allocations = 0;
		allocation_that_fails = at;
		rc = state_create(&state, path);
		allocation_that_fails = -1;
		CHECK(rc == -ENOMEM || (rc == 0 && active(state) == 7));
		CHECK(!exists(".broken"));
		if (rc == 0)
			state_destroy(state);
		CHECK(at < 200);
	}
	CHECK(allocations > 8);
}

/* It would be written over by what begins in its place. */
static void waits_for_a_second_copy_that_cannot_be_read_at_once(void **unused)
{
	struct state *state = open_state();

	(void)unused;
	CHECK(activate(state, 7) == 0);
	state_destroy(state);
	write_at("", 0, "no database");
	seconds_that_fail = 2;
	state = open_state();
	CHECK(seconds_that_fail == 0 && exists(".broken"));
	CHECK(active(state) == 7 && state_sequence_floor(state) == 7);
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

/* ---- floors that fall with the keys that set them */

static struct signing_key root_key;

/* root/VERSION.json, as far as the state looks at it. */
static void encode_root(struct buffer *out, uint32_t version)
{
	struct trust_root root = { .version = version, .expires_s = 2000000000 };

	CHECK(sodium_init() >= 0);
	if (version == 1)
		CHECK(crypto_sign_keypair(root_key.public_key, root_key.secret) == 0);
	for (int role = 0; role < 3; role++) {
		memcpy(root.roles[role].keys[0], root_key.public_key, KEY_BYTES);
		root.roles[role].key_count = root.roles[role].threshold = 1;
	}
	buffer_init(out, METADATA_FILE_BYTES_MAX);
	CHECK(trust_root_encode(out, &root, &root_key, 1) == 0);
}

static int set_root(struct state *state, uint32_t version, enum state_clear clear)
{
	struct buffer root;
	int rc;

	encode_root(&root, version);
	rc = state_set_trust(state, buffer_bytes(&root), clear);
	buffer_finish(&root);
	return rc;
}

static bool has_root(const struct state *state, uint32_t version)
{
	struct trust_root root = { 0 };
	struct bytes file;

	return state_trust(state, &file) == 0 && trust_root_first(&root, file, NULL) == 0 &&
	       root.version == version;
}

static void clears_the_floors_that_it_is_told_to(void **unused)
{
	(void)unused;
	for (int clear = STATE_CLEAR_NOTHING; clear <= STATE_CLEAR_BOTH_FLOORS; clear++) {
		struct state *state = open_state();

		CHECK(set_root(state, 1, STATE_CLEAR_BOTH_FLOORS) == 0);
		CHECK(activate(state, 9) == 0);
		CHECK(state_raise_time_floor(state, 1700000000) == 0);
		CHECK(set_root(state, 2, (enum state_clear)clear) == 0);
		for (int start = 0; start < 2; start++) {
			CHECK(active(state) == 9 && has_root(state, 2));
			CHECK(state_sequence_floor(state) ==
			      (clear & STATE_CLEAR_SEQUENCE_FLOOR ? 0 : 9));
			CHECK(state_time_floor_s(state) ==
			      (clear & STATE_CLEAR_TIME_FLOOR ? 0 : 1700000000));
			state_destroy(state);
			state = open_state();
		}
		CHECK(activate(state, 3) == (clear & STATE_CLEAR_SEQUENCE_FLOOR ? 0 : -ESTALE));
		state_destroy(state);
	}
}

/* Power goes at every write in turn: the root and what it clears are both there or both not. */
static void a_root_and_what_it_clears_are_one_change(void **unused)
{
	int olds = 0, news = 0;
	char command[128];

	(void)unused;
	snprintf(command, sizeof(command), "rm -f %s*", path);
	for (long at = 0; at < 40; at++) {
		struct state *state;
		bool is_new;
		int rc;

		CHECK(system(command) == 0);
		state = open_state();
		CHECK(set_root(state, 1, STATE_CLEAR_NOTHING) == 0 && activate(state, 9) == 0);
		CHECK(state_raise_time_floor(state, 1700000000) == 0);
		fault_set(FAULT_POWER_CUT, at, 0);
		rc = set_root(state, 2, STATE_CLEAR_BOTH_FLOORS);
		state_destroy(state);
		fault_set(FAULT_NONE, 0, 0);
		state = open_state();
		is_new = has_root(state, 2);
		CHECK(is_new || has_root(state, 1));
		CHECK(rc < 0 || is_new);
		CHECK(state_sequence_floor(state) == (is_new ? 0 : 9));
		CHECK(state_time_floor_s(state) == (is_new ? 0 : 1700000000));
		CHECK(active(state) == 9);
		state_destroy(state);
		olds += !is_new;
		news += is_new;
	}
	CHECK(olds > 0 && news > 0);
}

/* The power went after the database was written and before PATH.second was. */
static void a_second_copy_of_before_the_root_does_not_bring_the_floors_back(void **unused)
{
	struct state *state = open_state();
	struct buffer second;
	char name[128];

	(void)unused;
	snprintf(name, sizeof(name), "%s.second", path);
	CHECK(set_root(state, 1, STATE_CLEAR_NOTHING) == 0 && activate(state, 9) == 0);
	CHECK(state_raise_time_floor(state, 1700000000) == 0);
	buffer_init(&second, 1 << 20);
	CHECK(buffer_read_file(&second, name) == 0);
	CHECK(set_root(state, 2, STATE_CLEAR_BOTH_FLOORS) == 0);
	state_destroy(state);
	CHECK(bytes_write_file(buffer_bytes(&second), name) == 0);
	state = open_state();
	CHECK(has_root(state, 2) && active(state) == 9);
	CHECK(state_sequence_floor(state) == 0 && state_time_floor_s(state) == 0);
	CHECK(activate(state, 3) == 0);
	state_destroy(state);
	buffer_finish(&second);
}

/* Earlier programs wrote what the clock had said; there it was 2099 once. */
static void write_an_earlier_programs_time_floor(const struct record *record)
{
	sqlite3_stmt *update = NULL;
	struct hash check;
	sqlite3 *db;

	CHECK(record_write_second(record, path) == 0 && record_hash(&check, record) == 0);
	CHECK(db_open(&db, path) == 0);
	CHECK(sqlite3_prepare_v2(db, "UPDATE record SET time_floor_s = ?, check_hash = ?", -1,
				 &update, NULL) == SQLITE_OK);
	sqlite3_bind_int64(update, 1, record->stored_time_floor_s);
	sqlite3_bind_blob(update, 2, check.bytes, HASH_BYTES, SQLITE_STATIC);
	CHECK(sqlite3_step(update) == SQLITE_DONE && sqlite3_changes(db) == 1);
	sqlite3_finalize(update);
	sqlite3_close(db);
}

static void drops_a_time_floor_that_a_clock_had_set(void **unused)
{
	struct state *state = open_state();
	struct record record;

	(void)unused;
	CHECK(activate(state, 3) == 0);
	state_destroy(state);
	record_init(&record);
	CHECK(record_read_second(&record, path) == 0);
	record.stored_time_floor_s = 4090000000;
	write_an_earlier_programs_time_floor(&record);
	record_finish(&record);
	for (int start = 0; start < 2; start++) {
		state = open_state();
		CHECK(active(state) == 3 && state_sequence_floor(state) == 3 && !exists(".broken"));
		CHECK(state_time_floor_s(state) == (start ? 1700000000 : 0));
		CHECK(state_raise_time_floor(state, 1700000000) == 0);
		state_destroy(state);
	}
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

/* ---- metadata of The Update Framework */

static struct state_tuf tuf(uint8_t n)
{
	static uint8_t files[256][64];

	memset(files[n], n, sizeof(files[n]));
	return (struct state_tuf){
		{ files[n], 64 }, { files[n], 10 }, { files[n], 11 }, { files[n], 12 }
	};
}

static void set_tuf(struct state *state, uint8_t n, enum state_clear clear)
{
	const struct state_tuf files = tuf(n);

	CHECK(state_set_tuf(state, &files, clear) == 0);
}

/* The number of the files that are kept, all of them checked; 0: none. */
static int kept_tuf(const struct state *state)
{
	struct state_tuf now, expected;

	if (state_tuf(state, &now) == -ENOENT)
		return 0;
	expected = tuf(now.root.data[0]);
	CHECK(bytes_equal(now.root, expected.root) &&
	      bytes_equal(now.timestamp, expected.timestamp) &&
	      bytes_equal(now.snapshot, expected.snapshot) &&
	      bytes_equal(now.targets, expected.targets));
	return now.root.data[0];
}

static void copy_file(const char *from, const char *to)
{
	char command[256];

	snprintf(command, sizeof(command), "cp %s%s %s%s", path, from, path, to);
	CHECK(system(command) == 0);
}

static void keeps_tuf_across_a_restart_and_damage(void **unused)
{
	struct state *state = open_state();

	(void)unused;
	CHECK(kept_tuf(state) == 0);
	set_tuf(state, 1, STATE_CLEAR_NOTHING);
	set_tuf(state, 2, STATE_CLEAR_NOTHING);
	CHECK(activate(state, 3) == 0);
	state_destroy(state);
	state = open_state();
	CHECK(kept_tuf(state) == 2 && active(state) == 3);
	state_destroy(state);
	write_at("", 0, "not a database at all");
	state = open_state();
	CHECK(kept_tuf(state) == 2 && active(state) == 3);
	state_destroy(state);
}

static void a_row_of_tuf_that_was_changed_is_not_believed(void **unused)
{
	struct state *state = open_state();
	sqlite3 *db;

	(void)unused;
	set_tuf(state, 5, STATE_CLEAR_NOTHING);
	CHECK(activate(state, 3) == 0);
	state_destroy(state);
	CHECK(db_open(&db, path) == 0);
	CHECK(db_exec(db, "UPDATE tuf SET timestamp = x'00'") == 0);
	CHECK(sqlite3_close(db) == SQLITE_OK);
	state = open_state(); /* from the second copy */
	CHECK(kept_tuf(state) == 5 && active(state) == 3 && exists(".broken"));
	state_destroy(state);
}

static void an_old_database_put_back_does_not_bring_old_tuf_back(void **unused)
{
	struct state *state = open_state();

	(void)unused;
	set_tuf(state, 1, STATE_CLEAR_NOTHING);
	state_destroy(state);
	copy_file("", ".old");
	state = open_state();
	set_tuf(state, 2, STATE_CLEAR_NOTHING);
	state_destroy(state);
	copy_file(".old", "");
	state = open_state();
	CHECK(kept_tuf(state) == 2);
	set_tuf(state, 3, STATE_CLEAR_NOTHING);
	state_destroy(state);
	state = open_state();
	CHECK(kept_tuf(state) == 3);
	state_destroy(state);
}

static void a_second_copy_of_before_a_tuf_root_does_not_bring_the_floors_back(void **unused)
{
	struct state *state = open_state();

	(void)unused;
	set_tuf(state, 1, STATE_CLEAR_NOTHING);
	CHECK(activate(state, 200) == 0);
	state_destroy(state);
	copy_file(".second", ".second.old");
	state = open_state();
	set_tuf(state, 2, STATE_CLEAR_BOTH_FLOORS);
	CHECK(state_sequence_floor(state) == 0);
	state_destroy(state);
	copy_file(".second.old", ".second"); /* the power failed between the two writes */
	state = open_state();
	CHECK(kept_tuf(state) == 2 && state_sequence_floor(state) == 0);
	state_destroy(state);
}

/* After an update that failed, the other slot's program writes the record as it knows it. */
static void a_program_that_knows_no_tuf_uses_the_same_record(void **unused)
{
	struct state *state = open_state();
	struct record record, again;
	struct hash hash, stored;
	sqlite3_stmt *select;
	sqlite3 *db;

	(void)unused;
	set_tuf(state, 1, STATE_CLEAR_NOTHING);
	CHECK(activate(state, 3) == 0);
	state_destroy(state);
	record_init(&record);
	record_init(&again);
	CHECK(record_read_second(&record, path) == 0);
	record_copy_tuf(&record, &again); /* none */
	CHECK(record_hash(&hash, &record) == 0);
	CHECK(db_open(&db, path) == 0);
	CHECK(sqlite3_prepare_v2(db, "SELECT check_hash FROM record", -1, &select, NULL) ==
	      SQLITE_OK);
	CHECK(sqlite3_step(select) == SQLITE_ROW && sqlite3_column_bytes(select, 0) == HASH_BYTES);
	memcpy(stored.bytes, sqlite3_column_blob(select, 0), HASH_BYTES);
	sqlite3_finalize(select);
	CHECK(sqlite3_close(db) == SQLITE_OK);
	CHECK(hash_equal(hash, stored));
	record_finish(&record);
	record_finish(&again);
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
		IN_A_FOLDER(a_read_that_fails_is_no_damage),
		IN_A_FOLDER(a_lack_of_memory_is_no_damage),
		IN_A_FOLDER(waits_for_a_second_copy_that_cannot_be_read_at_once),
		IN_A_FOLDER(begins_anew_when_both_copies_are_damaged),
		IN_A_FOLDER(keeps_the_floor_when_an_old_database_is_put_back),
		IN_A_FOLDER(clears_the_floors_that_it_is_told_to),
		IN_A_FOLDER(a_root_and_what_it_clears_are_one_change),
		IN_A_FOLDER(a_second_copy_of_before_the_root_does_not_bring_the_floors_back),
		IN_A_FOLDER(drops_a_time_floor_that_a_clock_had_set),
		IN_A_FOLDER(survives_a_database_cut_anywhere),
		IN_A_FOLDER(keeps_the_last_release_that_worked),
		IN_A_FOLDER(falls_back_without_lowering_the_floor),
		IN_A_FOLDER(signs_the_same_root_anew_without_a_trial),
		IN_A_FOLDER(is_old_or_new_after_a_power_cut_anywhere),
		IN_A_FOLDER(refuses_changes_on_a_full_disk_and_goes_on),
		IN_A_FOLDER(lives_without_a_disk),
		IN_A_FOLDER(keeps_tuf_across_a_restart_and_damage),
		IN_A_FOLDER(a_row_of_tuf_that_was_changed_is_not_believed),
		IN_A_FOLDER(an_old_database_put_back_does_not_bring_old_tuf_back),
		IN_A_FOLDER(a_second_copy_of_before_a_tuf_root_does_not_bring_the_floors_back),
		IN_A_FOLDER(a_program_that_knows_no_tuf_uses_the_same_record),
	};

	fault_install();
	return cmocka_run_group_tests(tests, NULL, NULL);
}
