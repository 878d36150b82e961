/* Keeps the kiosk's state as one record in an SQLite database and in a second copy, and recovers it
 * after damage. */
#include "storage/state.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base/log.h"
#include "base/transient.h"
#include "format/metadata.h"
#include "storage/db.h"
#include "storage/state_record.h"

enum {
	BROKEN_BYTES_MAX = 1 << 20,
	OPEN_TRIES = 4,
	OPEN_PAUSE_MS = 50,
	/* the time floor is written only when it rises by at least this */
	TIME_STEP_S = 3600,
};

struct state {
	char path[PATH_MAX];
	sqlite3 *db; /* NULL: could not be opened; nothing is written */
	struct record record;
	/* as last written to disk */
	int64_t written_time_floor_s;
};

static const char schema[] =
	"BEGIN IMMEDIATE;"
	"CREATE TABLE IF NOT EXISTS record (id INTEGER PRIMARY KEY CHECK (id = 1),"
	" sequence_floor INTEGER, time_floor_s INTEGER, root BLOB, root_bytes INTEGER,"
	" sequence INTEGER, release BLOB, trust BLOB, tries INTEGER, previous_root BLOB,"
	" previous_root_bytes INTEGER, previous_sequence INTEGER, previous_release BLOB,"
	" check_hash BLOB);"
	"CREATE TABLE IF NOT EXISTS tuf (id INTEGER PRIMARY KEY CHECK (id = 1), changes INTEGER,"
	" root BLOB, timestamp BLOB, snapshot BLOB, targets BLOB, check_hash BLOB);"
	"COMMIT";

/* ---- the database */

static void take_column(struct buffer *out, sqlite3_stmt *row, int column)
{
	const void *bytes = sqlite3_column_blob(row, column);
	int size = sqlite3_column_bytes(row, column);

	buffer_clear(out);
	if (bytes)
		buffer_put(out, bytes, (size_t)size);
}

/* What there was no memory for is not damaged. */
static int damage_of(int rc)
{
	return rc < 0 && rc != -ENOMEM ? -EBADMSG : rc;
}

/* Reads a release from four consecutive columns. */
static int take_release(struct kept_release *out, sqlite3_stmt *row, int column)
{
	if (sqlite3_column_bytes(row, column) != HASH_BYTES)
		return -EBADMSG;
	memcpy(out->root.bytes, sqlite3_column_blob(row, column), HASH_BYTES);
	out->root_bytes = (uint32_t)sqlite3_column_int64(row, column + 1);
	out->sequence = (uint64_t)sqlite3_column_int64(row, column + 2);
	take_column(&out->file, row, column + 3);
	return 0;
}

static int take_row(struct record *out, sqlite3_stmt *row)
{
	struct hash check;
	int rc;

	out->sequence_floor = (uint64_t)sqlite3_column_int64(row, 0);
	out->stored_time_floor_s = sqlite3_column_int64(row, 1);
	take_column(&out->trust, row, 6);
	out->tries = (uint32_t)sqlite3_column_int64(row, 7);
	if (take_release(&out->release, row, 2) < 0 || take_release(&out->previous, row, 8) < 0 ||
	    sqlite3_column_bytes(row, 12) != HASH_BYTES)
		return -EBADMSG;
	rc = record_error(out);
	if (rc == 0)
		rc = record_hash(&check, out);
	if (rc < 0)
		return damage_of(rc);
	return memcmp(check.bytes, sqlite3_column_blob(row, 12), HASH_BYTES) == 0 ? 0 : -EBADMSG;
}

static int take_tuf(struct record *out, sqlite3_stmt *row)
{
	struct hash check;
	int rc;

	out->tuf.changes = (uint64_t)sqlite3_column_int64(row, 0);
	for (int i = 0; i < KEPT_TUF_FILES; i++)
		take_column(&out->tuf.files[i], row, 1 + i);
	if (sqlite3_column_bytes(row, 5) != HASH_BYTES)
		return -EBADMSG;
	rc = record_error(out);
	if (rc == 0)
		rc = record_tuf_hash(&check, out);
	if (rc < 0)
		return damage_of(rc);
	return memcmp(check.bytes, sqlite3_column_blob(row, 5), HASH_BYTES) == 0 ? 0 : -EBADMSG;
}

/* Without a row, nothing is read. -EBADMSG: it is damaged. */
static int read_tuf(struct record *out, sqlite3 *db)
{
	sqlite3_stmt *select = NULL;
	int code = sqlite3_prepare_v2(
		db,
		"SELECT changes, root, timestamp, snapshot, targets, check_hash FROM tuf"
		" WHERE id = 1",
		-1, &select, NULL);
	int rc;

	if (code == SQLITE_ERROR) /* no such column: the table is not ours */
		return -EBADMSG;
	if (code == SQLITE_OK)
		code = sqlite3_step(select);
	rc = code == SQLITE_ROW ? take_tuf(out, select) : db_code(code);
	sqlite3_finalize(select);
	return rc;
}

/* -ENOENT: the database is new and has no record. -EBADMSG: the record is damaged. */
static int read_record(struct record *out, sqlite3 *db)
{
	sqlite3_stmt *select = NULL;
	int code = sqlite3_prepare_v2(
		db,
		"SELECT sequence_floor, time_floor_s, root, root_bytes, sequence, release, trust,"
		" tries, previous_root, previous_root_bytes, previous_sequence, previous_release,"
		" check_hash FROM record WHERE id = 1",
		-1, &select, NULL);
	int rc;

	if (code == SQLITE_ERROR) /* no such column: the table is not ours */
		return -EBADMSG;
	if (code == SQLITE_OK)
		code = sqlite3_step(select);
	rc = db_code(code);
	if (code == SQLITE_ROW)
		rc = take_row(out, select);
	else if (code == SQLITE_DONE)
		rc = -ENOENT;
	sqlite3_finalize(select);
	return rc == 0 ? read_tuf(out, db) : rc;
}

static void bind_release(sqlite3_stmt *insert, int first, const struct kept_release *release)
{
	sqlite3_bind_blob(insert, first, release->root.bytes, HASH_BYTES, SQLITE_STATIC);
	sqlite3_bind_int64(insert, first + 1, release->root_bytes);
	sqlite3_bind_int64(insert, first + 2, (sqlite3_int64)release->sequence);
	sqlite3_bind_blob(insert, first + 3, release->file.data, (int)release->file.size,
			  SQLITE_STATIC);
}

static int write_row(sqlite3 *db, const struct record *record)
{
	sqlite3_stmt *insert = NULL;
	struct hash check;
	int rc = record_hash(&check, record);

	if (rc == 0)
		rc = db_code(sqlite3_prepare_v2(db,
						"INSERT OR REPLACE INTO record VALUES"
						" (1, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
						-1, &insert, NULL));
	if (rc < 0)
		return rc;
	sqlite3_bind_int64(insert, 1, (sqlite3_int64)record->sequence_floor);
	sqlite3_bind_int64(insert, 2, record->stored_time_floor_s);
	bind_release(insert, 3, &record->release);
	sqlite3_bind_blob(insert, 7, record->trust.data, (int)record->trust.size, SQLITE_STATIC);
	sqlite3_bind_int64(insert, 8, record->tries);
	bind_release(insert, 9, &record->previous);
	sqlite3_bind_blob(insert, 13, check.bytes, HASH_BYTES, SQLITE_STATIC);
	rc = db_run(insert);
	if (rc < 0)
		rc = db_error(db, sqlite3_extended_errcode(db), "writing the kiosk's state");
	sqlite3_finalize(insert);
	return rc;
}

static int write_tuf(sqlite3 *db, const struct record *record)
{
	sqlite3_stmt *insert = NULL;
	struct hash check;
	int rc = record_tuf_hash(&check, record);

	if (rc == 0)
		rc = db_code(sqlite3_prepare_v2(
			db, "INSERT OR REPLACE INTO tuf VALUES (1, ?, ?, ?, ?, ?, ?)", -1, &insert,
			NULL));
	if (rc < 0)
		return rc;
	sqlite3_bind_int64(insert, 1, (sqlite3_int64)record->tuf.changes);
	for (int i = 0; i < KEPT_TUF_FILES; i++)
		sqlite3_bind_blob(insert, 2 + i, record->tuf.files[i].data,
				  (int)record->tuf.files[i].size, SQLITE_STATIC);
	sqlite3_bind_blob(insert, 6, check.bytes, HASH_BYTES, SQLITE_STATIC);
	rc = db_run(insert);
	if (rc < 0)
		rc = db_error(db, sqlite3_extended_errcode(db), "writing the trusted metadata");
	sqlite3_finalize(insert);
	return rc;
}

/* Writes the record, and the files of The Update Framework if they changed, together. */
static int write_record(sqlite3 *db, const struct record *record, bool with_tuf)
{
	int rc;

	if (!with_tuf)
		return write_row(db, record);
	rc = db_exec(db, "BEGIN IMMEDIATE");
	if (rc < 0)
		return rc;
	rc = write_row(db, record);
	if (rc == 0)
		rc = write_tuf(db, record);
	if (rc == 0)
		rc = db_exec(db, "COMMIT");
	if (rc < 0 && !sqlite3_get_autocommit(db) && db_exec(db, "ROLLBACK") < 0)
		log_debug("storage", "a change of the state could not be taken back");
	return rc;
}

static void close_db(struct state *state)
{
	sqlite3_close_v2(state->db);
	state->db = NULL;
}

/* Opens the database and reads the record. -ENOENT: the database is new. -EBADMSG: it is
 * damaged. -EIO, -ENOMEM: it cannot be read now. */
static int open_db(struct state *state)
{
	int rc = db_open(&state->db, state->path);

	if (rc == 0)
		rc = db_exec(state->db, "PRAGMA journal_mode=WAL; PRAGMA synchronous=FULL");
	if (rc == 0)
		rc = db_exec(state->db, schema);
	if (rc == 0)
		rc = read_record(&state->record, state->db);
	if (rc == -EBADMSG && db_read_failed(state->db))
		return -EIO;
	/* SQLite opened it read-only although the file is writable: its header claims a newer
	 * format. */
	return rc == -EROFS && access(state->path, W_OK) == 0 ? -EBADMSG : rc;
}

/* Forgets what was read of a record, and waits a moment. */
static void begin_again(struct record *record)
{
	const struct timespec moment = { .tv_nsec = OPEN_PAUSE_MS * 1000000 };

	record_finish(record);
	record_init(record);
	nanosleep(&moment, NULL);
}

/* The same, again after a moment where it cannot be read: until the next start nothing can be
 * stored otherwise. */
static int open_patiently(struct state *state)
{
	int rc = open_db(state);

	for (int tries = 1; tries < OPEN_TRIES && is_transient(rc); tries++) {
		close_db(state);
		begin_again(&state->record);
		rc = open_db(state);
	}
	return rc;
}

/* The same for the second copy: what takes its place would be written over it. */
static int read_second_patiently(struct record *out, const char *path)
{
	int rc = record_read_second(out, path);

	for (int tries = 1; tries < OPEN_TRIES && is_transient(rc); tries++) {
		begin_again(out);
		rc = record_read_second(out, path);
	}
	return rc;
}

/* ---- damage and recovery */

/* Raises each floor of record to that of other, if that is higher. */
static void raise_floors(struct record *record, const struct record *other)
{
	if (other->sequence_floor > record->sequence_floor)
		record->sequence_floor = other->sequence_floor;
	if (record_time_floor_s(other) > record_time_floor_s(record))
		record_set_time_floor(record, record_time_floor_s(other));
}

/* Sets *out to the version of the trust root; 0: there is none, or it is not a root file. -ENOMEM.
 */
static int root_version(uint32_t *out, const struct record *record)
{
	struct trust_root root;
	int rc = trust_root_first(&root, buffer_bytes(&record->trust), NULL);

	*out = rc == 0 ? root.version : 0;
	return rc == -ENOMEM ? rc : 0;
}

/* An older database that was put back must not lower the floors, so the floors of the second copy
 * count too, and so do its files of The Update Framework. But a second copy with an older trust
 * root, or with older such files, must not raise the floors: the newer root may have cleared them,
 * and the power may have failed between the two writes. */
static int compare_with_second(struct state *state)
{
	struct record second;
	uint32_t its_root = 0, root = 0;
	int rc;

	record_init(&second);
	rc = read_second_patiently(&second, state->path);
	if (rc == 0)
		rc = root_version(&its_root, &second);
	if (rc == 0)
		rc = root_version(&root, &state->record);
	if (rc == 0 && its_root >= root && second.tuf.changes >= state->record.tuf.changes) {
		raise_floors(&state->record, &second);
		/* The database is always written first, so this one is an older one put back. */
		if (second.tuf.changes > state->record.tuf.changes)
			record_copy_tuf(&state->record, &second);
	}
	record_finish(&second);
	return rc == -ENOMEM ? rc : 0; /* otherwise there is no second copy to use */
}

/* The database could not be read (rc says why): uses the second copy, if that is intact. */
static void recover(struct state *state, int rc)
{
	bool damaged = rc == -EBADMSG;

	record_finish(&state->record);
	record_init(&state->record);
	if (damaged) {
		close_db(state);
		log_error("storage", "%s is damaged; renamed to %s.broken", state->path,
			  state->path);
		rc = db_set_aside(state->path, BROKEN_BYTES_MAX);
		if (rc == 0)
			rc = open_db(state);
	}
	if (rc < 0 && rc != -ENOENT) {
		log_error("storage", "%s: %s; the state cannot be stored", state->path,
			  state->db ? sqlite3_errmsg(state->db) : strerror(-rc));
		close_db(state);
	}
	if (read_second_patiently(&state->record, state->path) < 0) {
		record_finish(&state->record);
		record_init(&state->record);
		if (damaged)
			log_error("storage",
				  "%s.second cannot be used either; the state begins empty",
				  state->path);
	} else {
		log_warn("storage", "the state was restored from %s.second", state->path);
	}
	if (state->db && write_record(state->db, &state->record, true) < 0)
		close_db(state);
}

int state_create(struct state **out, const char *path)
{
	struct state *state = calloc(1, sizeof(*state));
	int rc;

	*out = NULL;
	if (!state)
		return -ENOMEM;
	snprintf(state->path, sizeof(state->path), "%s", path);
	record_init(&state->record);
	record_drop_leftovers(path);
	rc = open_patiently(state);
	if (rc < 0) {
		recover(state, rc);
	} else if ((rc = compare_with_second(state)) < 0) {
		state_destroy(state);
		return rc;
	}
	state->written_time_floor_s = record_time_floor_s(&state->record);
	*out = state;
	return 0;
}

void state_destroy(struct state *state)
{
	if (!state)
		return;
	close_db(state);
	record_finish(&state->record);
	free(state);
}

/* ---- public functions */

static int tell_release(const struct kept_release *release, struct state_release *out)
{
	if (hash_is_zero(release->root))
		return -ENOENT;
	*out = (struct state_release){ release->root, release->root_bytes, release->sequence,
				       buffer_bytes(&release->file) };
	return 0;
}

int state_release(const struct state *state, struct state_release *out)
{
	return tell_release(&state->record.release, out);
}

int state_previous(const struct state *state, struct state_release *out)
{
	return tell_release(&state->record.previous, out);
}

uint32_t state_tries(const struct state *state)
{
	return state->record.tries;
}

int state_trust(const struct state *state, struct bytes *out)
{
	*out = buffer_bytes(&state->record.trust);
	return out->size ? 0 : -ENOENT;
}

int state_tuf(const struct state *state, struct state_tuf *out)
{
	const struct buffer *files = state->record.tuf.files;

	*out = (struct state_tuf){ buffer_bytes(&files[0]), buffer_bytes(&files[1]),
				   buffer_bytes(&files[2]), buffer_bytes(&files[3]) };
	return out->root.size ? 0 : -ENOENT;
}

uint64_t state_sequence_floor(const struct state *state)
{
	return state->record.sequence_floor;
}

int64_t state_time_floor_s(const struct state *state)
{
	return record_time_floor_s(&state->record);
}

/* Writes *next. It is taken: it becomes the record, or is freed on failure. */
static int change(struct state *state, struct record *next)
{
	int rc = record_error(next);

	if (rc == 0)
		rc = state->db ? write_record(state->db, next,
					      next->tuf.changes != state->record.tuf.changes)
			       : -EIO;
	if (rc < 0) {
		record_finish(next);
		return rc;
	}
	record_finish(&state->record);
	state->record = *next;
	state->written_time_floor_s = record_time_floor_s(next);
	/* The database has the record; a failure here costs only the second copy. */
	if (record_write_second(&state->record, state->path) < 0)
		log_warn("storage", "%s.second could not be written", state->path);
	return 0;
}

/* The release in use becomes the previous one. The old previous one is freed, and record->release
 * is left empty. */
static void make_previous(struct record *record)
{
	buffer_finish(&record->previous.file);
	record->previous = record->release;
	record->release = (struct kept_release){ 0 };
	buffer_init(&record->release.file, STATE_FILE_BYTES_MAX);
}

int state_activate(struct state *state, const struct state_release *release)
{
	struct record next;

	if (release->sequence < state->record.sequence_floor)
		return -ESTALE;
	record_copy(&next, &state->record);
	if (!hash_equal(next.release.root, release->root)) {
		if (next.tries == 0 && !hash_is_zero(next.release.root))
			make_previous(&next);
		next.tries = 1;
	}
	next.release.root = release->root;
	next.release.root_bytes = release->root_bytes;
	next.release.sequence = next.sequence_floor = release->sequence;
	buffer_clear(&next.release.file);
	buffer_put(&next.release.file, release->file.data, release->file.size);
	return change(state, &next);
}

static int change_tries(struct state *state, uint32_t tries)
{
	struct record next;

	record_copy(&next, &state->record);
	next.tries = tries;
	return change(state, &next);
}

int state_try(struct state *state)
{
	if (state->record.tries == 0 || hash_is_zero(state->record.previous.root))
		return 0;
	return change_tries(state, state->record.tries + 1);
}

int state_prove(struct state *state)
{
	return state->record.tries == 0 ? 0 : change_tries(state, 0);
}

int state_fall_back(struct state *state)
{
	struct record next;

	if (hash_is_zero(state->record.previous.root))
		return -ENOENT;
	record_copy(&next, &state->record);
	buffer_finish(&next.release.file);
	next.release = next.previous;
	next.previous = (struct kept_release){ 0 };
	buffer_init(&next.previous.file, STATE_FILE_BYTES_MAX);
	next.tries = 0;
	return change(state, &next);
}

static void clear_floors(struct record *record, enum state_clear clear)
{
	if (clear & STATE_CLEAR_SEQUENCE_FLOOR)
		record->sequence_floor = 0;
	if (clear & STATE_CLEAR_TIME_FLOOR)
		record_set_time_floor(record, 0);
}

int state_set_trust(struct state *state, struct bytes file, enum state_clear clear)
{
	struct record next;

	record_copy(&next, &state->record);
	buffer_clear(&next.trust);
	buffer_put(&next.trust, file.data, file.size);
	clear_floors(&next, clear);
	return change(state, &next);
}

int state_set_tuf(struct state *state, const struct state_tuf *tuf, enum state_clear clear)
{
	const struct bytes files[KEPT_TUF_FILES] = { tuf->root, tuf->timestamp, tuf->snapshot,
						     tuf->targets };
	struct record next;

	record_copy(&next, &state->record);
	next.tuf.changes++;
	for (int i = 0; i < KEPT_TUF_FILES; i++) {
		buffer_clear(&next.tuf.files[i]);
		buffer_put(&next.tuf.files[i], files[i].data, files[i].size);
	}
	clear_floors(&next, clear);
	return change(state, &next);
}

int state_raise_time_floor(struct state *state, int64_t at_least_s)
{
	struct record next;

	if (at_least_s <= record_time_floor_s(&state->record))
		return 0;
	record_set_time_floor(&state->record, at_least_s);
	if (at_least_s - state->written_time_floor_s < TIME_STEP_S)
		return 0;
	record_copy(&next, &state->record);
	return change(state, &next);
}
