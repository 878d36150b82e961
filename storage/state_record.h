/* What the kiosk's state remembers, as one record; and its second copy, PATH.second. Private to the
 * state.
 *
 * The record, in memory all the time, stands twice on disk: as the row of a table whose columns a
 * person can read, with a hash over the encoded record; and encoded, with that hash behind it, in
 * PATH.second. The encoded form:
 *
 *   "GSta"  u32 version(2)  u64 sequence floor  u64 time floor, negated
 *   16 bytes root  u32 root bytes  u64 sequence  u32 size, release.json  u32 size, root/N.json
 *   u32 tries  of the previous release: 16 bytes root ... release.json
 *
 * Version 1 ended before the tries; such a copy is read, as of a release that is proven. */
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

struct record {
	uint64_t sequence_floor;
	int64_t stored_time_floor_s; /* see record_time_floor_s */
	struct kept_release release, previous;
	struct buffer trust; /* empty: none yet */
	uint32_t tries;      /* of release; 0: proven */
};

void record_init(struct record *record);
void record_finish(struct record *record);
/* *out is as record_init leaves it, with copies of its own. */
void record_copy(struct record *out, const struct record *from);
/* The floor from signed metadata, 0: none. On disk it is negative: earlier programs wrote what the
 * clock had said as a positive number, and a clock may have said anything. A positive one is
 * dropped here; and to an earlier program, which comes back with a slot of an earlier system, a
 * negative one is no floor, while the rest of the record stays good. */
int64_t record_time_floor_s(const struct record *record);
void record_set_time_floor(struct record *record, int64_t floor_s);
/* -EFBIG: a file did not fit. */
must_check int record_error(const struct record *record);
/* Of the encoded record. */
must_check int record_hash(struct hash *out, const struct record *record);

/* PATH.second, path being the database's. -EBADMSG: not such a record, or changed since it was
 * written; *out is to be finished all the same. */
must_check int record_read_second(struct record *out, const char *path);
must_check int record_write_second(const struct record *record, const char *path);
/* What power cuts left of it. */
void record_drop_leftovers(const char *path);

#endif
