/* Byte strings: a borrowed view, a growing buffer with a ceiling, and a bounds-checked reader.
 * Buffer and reader keep their first failure: later calls do nothing, and the caller checks once at
 * the end. Integers are little endian on disk and wire. */
#ifndef GOPURA_BASE_BYTES_H
#define GOPURA_BASE_BYTES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/compiler.h"

/* A borrowed view. */
struct bytes {
	const uint8_t *data;
	size_t size;
};

/* Returns whether both hold the same bytes. */
bool bytes_equal(struct bytes a, struct bytes b);

/* Owned by its holder; buffer_finish releases it. */
struct buffer {
	uint8_t *data;
	size_t size;
	size_t capacity;
	size_t ceiling; /* maximum size in bytes; growing past it fails */
	int error;      /* first failure: 0, -ENOMEM or -EFBIG; kept until buffer_clear */
};

/* Sets *buffer to empty. Memory is allocated at the first write. */
void buffer_init(struct buffer *buffer, size_t ceiling_bytes);
void buffer_finish(struct buffer *buffer); /* frees the memory; NULL and zeroed are fine */
void buffer_clear(struct buffer *buffer);  /* empties it and resets error; keeps the memory */

/* Appends size bytes with undefined contents and returns a pointer to them, borrowed until the next
 * call on the buffer. NULL on failure. */
uint8_t *buffer_extend(struct buffer *buffer, size_t size);
/* Append a copy of data, or a number in little endian. A failure is kept in error, to be checked
 * once at the end; after it nothing is written. */
void buffer_put(struct buffer *buffer, const void *data, size_t size);
void buffer_put_u8(struct buffer *buffer, uint8_t value);   /* 1 byte */
void buffer_put_u16(struct buffer *buffer, uint16_t value); /* 2 bytes */
void buffer_put_u32(struct buffer *buffer, uint32_t value); /* 4 bytes */
void buffer_put_u64(struct buffer *buffer, uint64_t value); /* 8 bytes */
void buffer_put_f32(struct buffer *buffer, float value);    /* IEEE 754 single precision */
void buffer_put_f64(struct buffer *buffer, double value);   /* IEEE 754 double precision */
/* Append text without its final zero. The formatted one needs room for a zero after it. */
void buffer_put_text(struct buffer *buffer, const char *text);
void buffer_print(struct buffer *buffer, const char *format, ...) printf_like(2, 3);
/* Appends the length as u16, then the bytes without terminator. Text longer than 65535 bytes sets
 * -EFBIG. */
void buffer_put_string(struct buffer *buffer, const char *text);
/* Returns a view of what was written; borrowed until the next call on the buffer. */
struct bytes buffer_bytes(const struct buffer *buffer);

struct reader {
	const uint8_t *data;
	size_t size;
	size_t at;
	bool failed; /* a read failed; every later read gives zero */
};

/* Reads numbers in little endian from bytes, which are borrowed. A read past the end gives zero and
 * sets failed, to be checked once at the end. */
void reader_init(struct reader *reader, struct bytes bytes);
/* Returns the number of bytes not read yet; 0 after a failure. */
size_t reader_left(const struct reader *reader);
uint8_t reader_u8(struct reader *reader);   /* 1 byte */
uint16_t reader_u16(struct reader *reader); /* 2 bytes */
uint32_t reader_u32(struct reader *reader); /* 4 bytes */
uint64_t reader_u64(struct reader *reader); /* 8 bytes */
float reader_f32(struct reader *reader);    /* IEEE 754 single precision */
double reader_f64(struct reader *reader);   /* IEEE 754 double precision */
/* Returns a view of the next size bytes, borrowed from the reader's bytes; empty on failure. */
struct bytes reader_bytes(struct reader *reader, size_t size);
/* Reads a text as buffer_put_string writes it into out, terminated. Sets failed if it does not fit
 * into out_bytes or holds a zero byte; out is then "". */
void reader_string(struct reader *reader, char *out, size_t out_bytes);

/* Reads a whole regular file into *out, which is cleared first. Returns 0 or a negative errno:
 * -EFBIG past the buffer's ceiling, -ENOMEM, and the errors of base/safe_open.h, which open_problem
 * explains. This one is for a path that we or the operator chose. */
must_check int buffer_read_file(struct buffer *out, const char *path);
/* As buffer_read_file, for a name from a foreign file or medium, below a folder that we trust.
 * Links are not followed. */
must_check int buffer_read_beneath(struct buffer *out, const char *folder, const char *name);
/* As buffer_read_file, for a path whose folder we trust and whose last component is foreign. */
must_check int buffer_read_foreign(struct buffer *out, const char *path);
/* Reads from the descriptor's position to its end into *out. fd is taken; if it is a negative
 * errno, it is returned. */
must_check int buffer_read_fd(struct buffer *out, int fd);
/* Reads exactly size bytes at an offset of a file. Returns 0 or a negative errno; -EBADMSG if the
 * file ends before. */
must_check int bytes_read_at(int fd, void *to, size_t size, uint64_t at);
enum { BYTES_PATH_MAX = 4096 };
/* Begins to replace a file: creates a temporary file beside path, and writes its name to temporary.
 * Returns its descriptor, owned by the caller, or a negative errno. */
must_check int bytes_begin_file(char temporary[BYTES_PATH_MAX], const char *path);
/* Writes all bytes to a descriptor. Returns 0 or a negative errno. */
must_check int bytes_write_to(int fd, struct bytes bytes);
/* The same, and calls fsync. */
must_check int bytes_fill_file(int fd, struct bytes bytes);
/* Ends it: closes fd and renames the temporary file to path, so path is replaced only when the new
 * file is complete. If rc is negative, because writing failed, removes it and returns rc. Does not
 * call fsync. */
must_check int bytes_end_file(int fd, const char *temporary, const char *path, int rc);
/* Calls fsync on the folder of path, so that a renamed file stays. Returns 0 or a negative errno.
 */
must_check int bytes_sync_folder_of(const char *path);
/* Writes a file atomically: temporary file beside it, fsync, rename, fsync of the folder. Returns 0
 * or a negative errno. */
must_check int bytes_write_file(struct bytes bytes, const char *path);
/* Removes temporary files of path that were left by power cuts. Call it only while nobody writes
 * path. */
void bytes_drop_leftovers(const char *path);
/* Removes temporary files of any path in a folder that were last changed before a time, in seconds
 * since 1970; another process may be writing younger ones. A missing folder is fine. */
void bytes_sweep_folder(const char *folder, int64_t before_s);
/* Removes a folder and the files in it, or a file. Folders in it stay, and it with them. */
void bytes_remove_folder(const char *path);

#endif
