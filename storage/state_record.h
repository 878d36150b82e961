/* The kiosk's state as one record, and its second copy PATH.second. Private to the state.
 *
 * The record is always in memory and is stored twice on disk: as a row of a table whose columns
 * people can read, with a hash over the encoded record; and in encoded form, followed by that hash,
 * in PATH.second. The encoded form:
 *
 *   "GSta"  u32 version(3)  u64 sequence floor  u64 time floor, negated
 *   16 bytes root  u32 root bytes  u64 sequence  u32 size, release.json  u32 size, root/N.json
 *   u32 tries  of the previous release: 16 bytes root ... release.json
 *   of The Update Framework: u64 changes, then root, timestamp, snapshot, targets, each after its
 *   u32 size
 *
 * Version 1 ended before the tries, version 2 before The Update Framework. Such copies are still
 * read; the release of version 1 counts as proven.
 *
 * In the database, the files of The Update Framework are a table of their own with a hash of its
 * own, because a program of the other slot that does not know them reads and writes the record. */
#ifndef GOPURA_STORAGE_STATE_RECORD_H
#define GOPURA_STORAGE_STATE_RECORD_H

#include "format/hash.h"
#include "storage/state.h"

struct kept_release {
	struct hash root; /* zero: none yet */
	uint32_t root_bytes;
	uint64_t sequence;
	struct buffer file;
};

/* The files in the order of struct state_tuf. */
enum { KEPT_TUF_ROOT, KEPT_TUF_FILES = 4 };

struct kept_tuf {
	uint64_t changes; /* how often they were set: of two copies, the higher one is newer */
	struct buffer files[KEPT_TUF_FILES]; /* the root's empty: this form is not followed */
};

struct record {
	uint64_t sequence_floor;
	int64_t stored_time_floor_s; /* negated; see record_time_floor_s */
	struct kept_release release, previous;
	struct buffer trust; /* empty: none yet */
	uint32_t tries;      /* tries of the release; 0: proven */
	struct kept_tuf tuf;
};

/* Makes an empty record. */
void record_init(struct record *record);
/* Frees the files. */
void record_finish(struct record *record);
/* Initialises *out and copies everything, including the files. Check record_error afterwards. */
void record_copy(struct record *out, const struct record *from);
/* The time floor from signed metadata in seconds since 1970; 0: none. It is stored as a negative
 * number. Earlier programs stored the clock's time as a positive number, and a clock may be wrong,
 * so a positive one is ignored here. If the system falls back to an earlier slot, the earlier
 * program ignores a negative floor and can still use the rest of the record. */
int64_t record_time_floor_s(const struct record *record);
/* Sets the time floor; floor_s >= 0. */
void record_set_time_floor(struct record *record, int64_t floor_s);
/* Returns the error of the record's buffers: 0, -EFBIG if a file did not fit, or -ENOMEM. */
must_check int record_error(const struct record *record);
/* Computes the hash of the encoded record as of version 2, and of what follows there. Returns a
 * buffer's error, as record_error. */
must_check int record_hash(struct hash *out, const struct record *record);
must_check int record_tuf_hash(struct hash *out, const struct record *record);
/* Replaces the files of The Update Framework by those of from. Check record_error afterwards. */
void record_copy_tuf(struct record *record, const struct record *from);

/* Reads PATH.second, where path is that of the database. -EBADMSG: not such a record, or it was
 * changed after it was written. -ENOMEM, and the errors of reading a file. *out must be finished in
 * any case. */
must_check int record_read_second(struct record *out, const char *path);
/* Writes PATH.second; the old copy stays on failure. Returns 0 or a negative errno. */
must_check int record_write_second(const struct record *record, const char *path);
/* Deletes temporary files of PATH.second that a power cut left behind. */
void record_drop_leftovers(const char *path);

#endif
