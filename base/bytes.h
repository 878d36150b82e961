/* Byte strings: a borrowed view, a growing buffer with a ceiling, and a bounds-checked reader.
 * Buffer and reader are sticky: after the first failure further calls do nothing and the failure
 * is judged once at the end. Integers are little endian on disk and wire. */
#ifndef GOPURA_BASE_BYTES_H
#define GOPURA_BASE_BYTES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/compiler.h"

/* Borrowed. */
struct bytes {
	const uint8_t *data;
	size_t size;
};

/* Owned by whoever holds it; buffer_finish releases it. */
struct buffer {
	uint8_t *data;
	size_t size;
	size_t capacity;
	size_t ceiling; /* bytes; growing past it fails */
	int error;      /* 0, or -ENOMEM, or -EFBIG, sticky */
};

/* Empty; allocates when first written to. */
void buffer_init(struct buffer *buffer, size_t ceiling_bytes);
void buffer_finish(struct buffer *buffer); /* NULL and zeroed are fine */
void buffer_clear(struct buffer *buffer);  /* keeps the memory, forgets the error */

/* Room for size more bytes, counted as written, contents undefined. NULL on failure. */
uint8_t *buffer_extend(struct buffer *buffer, size_t size);
/* Appends a copy, numbers little endian. Failures are kept in error, to be asked for once at the
 * end; nothing is written after one. */
void buffer_put(struct buffer *buffer, const void *data, size_t size);
void buffer_put_u8(struct buffer *buffer, uint8_t value);
void buffer_put_u16(struct buffer *buffer, uint16_t value);
void buffer_put_u32(struct buffer *buffer, uint32_t value);
void buffer_put_u64(struct buffer *buffer, uint64_t value);
void buffer_put_f32(struct buffer *buffer, float value);
void buffer_put_f64(struct buffer *buffer, double value);
/* u16 length, then the bytes, no terminator. Longer than 65535 bytes sets -EFBIG. */
void buffer_put_string(struct buffer *buffer, const char *text);
/* A view of what was written; borrowed until the next call on the buffer. */
struct bytes buffer_bytes(const struct buffer *buffer);

struct reader {
	const uint8_t *data;
	size_t size;
	size_t at;
	bool failed; /* read past the end; every later read gives zero */
};

/* Reads from borrowed bytes, numbers little endian. What lies past the end reads as zero and sets
 * failed, to be asked for once at the end. */
void reader_init(struct reader *reader, struct bytes bytes);
size_t reader_left(const struct reader *reader);
uint8_t reader_u8(struct reader *reader);
uint16_t reader_u16(struct reader *reader);
uint32_t reader_u32(struct reader *reader);
uint64_t reader_u64(struct reader *reader);
float reader_f32(struct reader *reader);
double reader_f64(struct reader *reader);
/* Borrowed from what the reader reads; empty on failure. */
struct bytes reader_bytes(struct reader *reader, size_t size);
/* Into out, terminated; fails where the text does not fit in out_bytes or holds a zero byte. */
void reader_string(struct reader *reader, char *out, size_t out_bytes);

/* Whole file into *out (cleared first). Negative errno, -EFBIG past the buffer's ceiling. Only
 * regular files are read (base/safe_open.h has the errors and their words): a path that we or the
 * operator chose; */
must_check int buffer_read_file(struct buffer *out, const char *path);
/* a name from a foreign file or medium, below a folder that we trust, no links; */
must_check int buffer_read_beneath(struct buffer *out, const char *folder, const char *name);
/* a path whose folder we trust, and whose last component is foreign. */
must_check int buffer_read_foreign(struct buffer *out, const char *path);
/* As far as it reads; fd is taken, or a negative errno that is given back. */
must_check int buffer_read_fd(struct buffer *out, int fd);
/* size bytes at a place of a file; -EBADMSG: it ends before. */
must_check int bytes_read_at(int fd, void *to, size_t size, uint64_t at);
enum { BYTES_PATH_MAX = 4096 };
/* A file that takes the place of another only when it is whole: bytes_begin_file gives a descriptor
 * of a temporary file beside path and its name; bytes_end_file closes it, and renames it, or
 * removes it where rc, which it gives back, tells that writing failed. */
must_check int bytes_begin_file(char temporary[BYTES_PATH_MAX], const char *path);
must_check int bytes_end_file(int fd, const char *temporary, const char *path, int rc);
/* Atomically: a temporary file beside it, fsync, rename, fsync of the folder. */
must_check int bytes_write_file(struct bytes bytes, const char *path);
/* Removes temporary files that power cuts left of path's. While nobody writes it. */
void bytes_drop_leftovers(const char *path);

#endif
