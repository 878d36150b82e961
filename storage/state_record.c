/* Encodes and decodes the state record, and reads and writes its second copy. */
#include "storage/state_record.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>

enum {
	RECORD_BYTES_MAX = (3 + KEPT_TUF_FILES) * STATE_FILE_BYTES_MAX + 256,
	RECORD_VERSION = 3,
	HASHED_VERSION = 2, /* what record_hash says, for programs that know no later one */
};

void record_init(struct record *record)
{
	*record = (struct record){ 0 };
	buffer_init(&record->release.file, STATE_FILE_BYTES_MAX);
	buffer_init(&record->previous.file, STATE_FILE_BYTES_MAX);
	buffer_init(&record->trust, STATE_FILE_BYTES_MAX);
	for (int i = 0; i < KEPT_TUF_FILES; i++)
		buffer_init(&record->tuf.files[i], STATE_FILE_BYTES_MAX);
}

void record_finish(struct record *record)
{
	buffer_finish(&record->release.file);
	buffer_finish(&record->previous.file);
	buffer_finish(&record->trust);
	for (int i = 0; i < KEPT_TUF_FILES; i++)
		buffer_finish(&record->tuf.files[i]);
}

int record_error(const struct record *record)
{
	for (int i = 0; i < KEPT_TUF_FILES; i++)
		if (record->tuf.files[i].error)
			return record->tuf.files[i].error;
	return record->release.file.error    ? record->release.file.error
	       : record->previous.file.error ? record->previous.file.error
					     : record->trust.error;
}

int64_t record_time_floor_s(const struct record *record)
{
	/* INT64_MIN has no positive counterpart. */
	return record->stored_time_floor_s < 0 && record->stored_time_floor_s != INT64_MIN
		       ? -record->stored_time_floor_s
		       : 0;
}

void record_set_time_floor(struct record *record, int64_t floor_s)
{
	record->stored_time_floor_s = -floor_s;
}

static void copy_file(struct buffer *out, const struct buffer *from)
{
	buffer_init(out, STATE_FILE_BYTES_MAX);
	buffer_put(out, from->data, from->size);
}

void record_copy(struct record *out, const struct record *from)
{
	*out = *from;
	copy_file(&out->release.file, &from->release.file);
	copy_file(&out->previous.file, &from->previous.file);
	copy_file(&out->trust, &from->trust);
	for (int i = 0; i < KEPT_TUF_FILES; i++)
		copy_file(&out->tuf.files[i], &from->tuf.files[i]);
}

void record_copy_tuf(struct record *record, const struct record *from)
{
	record->tuf.changes = from->tuf.changes;
	for (int i = 0; i < KEPT_TUF_FILES; i++) {
		buffer_clear(&record->tuf.files[i]);
		buffer_put(&record->tuf.files[i], from->tuf.files[i].data, from->tuf.files[i].size);
	}
}

static void release_encode(struct buffer *out, const struct kept_release *release)
{
	buffer_put(out, release->root.bytes, HASH_BYTES);
	buffer_put_u32(out, release->root_bytes);
	buffer_put_u64(out, release->sequence);
	buffer_put_u32(out, (uint32_t)release->file.size);
	buffer_put(out, release->file.data, release->file.size);
}

static void record_encode(struct buffer *out, const struct record *record, uint32_t version)
{
	buffer_put(out, "GSta", 4);
	buffer_put_u32(out, version);
	buffer_put_u64(out, record->sequence_floor);
	buffer_put_u64(out, (uint64_t)record->stored_time_floor_s);
	release_encode(out, &record->release);
	buffer_put_u32(out, (uint32_t)record->trust.size);
	buffer_put(out, record->trust.data, record->trust.size);
	buffer_put_u32(out, record->tries);
	release_encode(out, &record->previous);
}

static void tuf_encode(struct buffer *out, const struct kept_tuf *tuf)
{
	buffer_put_u64(out, tuf->changes);
	for (int i = 0; i < KEPT_TUF_FILES; i++) {
		buffer_put_u32(out, (uint32_t)tuf->files[i].size);
		buffer_put(out, tuf->files[i].data, tuf->files[i].size);
	}
}

static void get_sized(struct buffer *out, struct reader *reader)
{
	struct bytes bytes = reader_bytes(reader, reader_u32(reader));

	buffer_clear(out);
	buffer_put(out, bytes.data, bytes.size);
}

static void release_decode(struct kept_release *out, struct reader *reader)
{
	struct bytes root = reader_bytes(reader, HASH_BYTES);

	if (root.size)
		memcpy(out->root.bytes, root.data, HASH_BYTES);
	out->root_bytes = reader_u32(reader);
	out->sequence = reader_u64(reader);
	get_sized(&out->file, reader);
}

/* -EBADMSG: not such a record, or it was changed after it was written. -ENOMEM. */
static int record_decode(struct record *out, struct bytes file)
{
	struct bytes body = { file.data, file.size - HASH_BYTES };
	struct bytes magic;
	struct reader reader;
	struct hash check;
	uint32_t version;

	if (file.size < HASH_BYTES)
		return -EBADMSG;
	check = hash_of(body);
	if (memcmp(check.bytes, file.data + body.size, HASH_BYTES) != 0)
		return -EBADMSG;
	reader_init(&reader, body);
	magic = reader_bytes(&reader, 4);
	version = reader_u32(&reader);
	if (magic.size != 4 || memcmp(magic.data, "GSta", 4) != 0 || version < 1 ||
	    version > RECORD_VERSION)
		return -EBADMSG;
	out->sequence_floor = reader_u64(&reader);
	out->stored_time_floor_s = (int64_t)reader_u64(&reader);
	release_decode(&out->release, &reader);
	get_sized(&out->trust, &reader);
	if (version > 1) {
		out->tries = reader_u32(&reader);
		release_decode(&out->previous, &reader);
	}
	if (version > 2) {
		out->tuf.changes = reader_u64(&reader);
		for (int i = 0; i < KEPT_TUF_FILES; i++)
			get_sized(&out->tuf.files[i], &reader);
	}
	if (reader.failed || reader_left(&reader) > 0)
		return -EBADMSG;
	return record_error(out) == -EFBIG ? -EBADMSG : record_error(out);
}

int record_hash(struct hash *out, const struct record *record)
{
	struct buffer encoded;
	int rc;

	buffer_init(&encoded, RECORD_BYTES_MAX);
	record_encode(&encoded, record, HASHED_VERSION);
	rc = encoded.error;
	*out = hash_of(buffer_bytes(&encoded));
	buffer_finish(&encoded);
	return rc;
}

int record_tuf_hash(struct hash *out, const struct record *record)
{
	struct buffer encoded;
	int rc;

	buffer_init(&encoded, RECORD_BYTES_MAX);
	tuf_encode(&encoded, &record->tuf);
	rc = encoded.error;
	*out = hash_of(buffer_bytes(&encoded));
	buffer_finish(&encoded);
	return rc;
}

/* ---- PATH.second */

int record_read_second(struct record *out, const char *path)
{
	char name[PATH_MAX + 8];
	struct buffer file;
	int rc;

	snprintf(name, sizeof(name), "%s.second", path);
	buffer_init(&file, RECORD_BYTES_MAX);
	rc = buffer_read_file(&file, name);
	if (rc == 0)
		rc = record_decode(out, buffer_bytes(&file));
	buffer_finish(&file);
	return rc;
}

int record_write_second(const struct record *record, const char *path)
{
	char name[PATH_MAX + 8];
	struct buffer file;
	struct hash check;
	int rc;

	snprintf(name, sizeof(name), "%s.second", path);
	buffer_init(&file, RECORD_BYTES_MAX);
	record_encode(&file, record, RECORD_VERSION);
	tuf_encode(&file, &record->tuf);
	check = hash_of(buffer_bytes(&file));
	buffer_put(&file, check.bytes, HASH_BYTES);
	rc = file.error;
	if (rc == 0)
		rc = bytes_write_file(buffer_bytes(&file), name);
	buffer_finish(&file);
	return rc;
}

void record_drop_leftovers(const char *path)
{
	char name[PATH_MAX + 8];

	snprintf(name, sizeof(name), "%s.second", path);
	bytes_drop_leftovers(name);
}
