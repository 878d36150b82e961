/* Implements the byte buffer and the reader, and the functions that read whole files and replace
 * files atomically. */
#include "base/bytes.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/safe_open.h"

bool bytes_equal(struct bytes a, struct bytes b)
{
	return a.size == b.size && (a.size == 0 || memcmp(a.data, b.data, a.size) == 0);
}

void buffer_init(struct buffer *buffer, size_t ceiling_bytes)
{
	*buffer = (struct buffer){ .ceiling = ceiling_bytes };
}

void buffer_finish(struct buffer *buffer)
{
	if (!buffer)
		return;
	free(buffer->data);
	*buffer = (struct buffer){ .ceiling = buffer->ceiling };
}

void buffer_clear(struct buffer *buffer)
{
	buffer->size = 0;
	buffer->error = 0;
}

uint8_t *buffer_extend(struct buffer *buffer, size_t size)
{
	size_t capacity = buffer->capacity ? buffer->capacity : 256;
	uint8_t *grown;

	if (buffer->error)
		return NULL;
	if (size > buffer->ceiling - buffer->size) {
		buffer->error = -EFBIG;
		return NULL;
	}
	while (capacity - buffer->size < size && capacity < buffer->ceiling)
		capacity = capacity > buffer->ceiling / 2 ? buffer->ceiling : capacity * 2;
	if (capacity != buffer->capacity) {
		grown = realloc(buffer->data, capacity);
		if (!grown) {
			buffer->error = -ENOMEM;
			return NULL;
		}
		buffer->data = grown;
		buffer->capacity = capacity;
	}
	buffer->size += size;
	return buffer->data + buffer->size - size;
}

void buffer_put(struct buffer *buffer, const void *data, size_t size)
{
	uint8_t *to = buffer_extend(buffer, size);

	if (to && size)
		memcpy(to, data, size);
}

static void put_le(struct buffer *buffer, uint64_t value, size_t size)
{
	uint8_t *to = buffer_extend(buffer, size);

	for (size_t i = 0; to && i < size; i++)
		to[i] = (uint8_t)(value >> (8 * i));
}

void buffer_put_u8(struct buffer *buffer, uint8_t value)
{
	put_le(buffer, value, 1);
}

void buffer_put_u16(struct buffer *buffer, uint16_t value)
{
	put_le(buffer, value, 2);
}

void buffer_put_u32(struct buffer *buffer, uint32_t value)
{
	put_le(buffer, value, 4);
}

void buffer_put_u64(struct buffer *buffer, uint64_t value)
{
	put_le(buffer, value, 8);
}

void buffer_put_f32(struct buffer *buffer, float value)
{
	uint32_t bits;

	memcpy(&bits, &value, sizeof(bits));
	buffer_put_u32(buffer, bits);
}

void buffer_put_f64(struct buffer *buffer, double value)
{
	uint64_t bits;

	memcpy(&bits, &value, sizeof(bits));
	buffer_put_u64(buffer, bits);
}

void buffer_put_text(struct buffer *buffer, const char *text)
{
	buffer_put(buffer, text, strlen(text));
}

void buffer_print(struct buffer *buffer, const char *format, ...)
{
	va_list args, again;
	size_t size;
	char *to;

	va_start(args, format);
	va_copy(again, args);
	size = (size_t)vsnprintf(NULL, 0, format, args) + 1;
	to = (char *)buffer_extend(buffer, size);
	if (to) {
		vsnprintf(to, size, format, again);
		buffer->size--;
	}
	va_end(again);
	va_end(args);
}

void buffer_put_string(struct buffer *buffer, const char *text)
{
	size_t size = strlen(text);

	if (size > UINT16_MAX) {
		buffer->error = buffer->error ? buffer->error : -EFBIG;
		return;
	}
	buffer_put_u16(buffer, (uint16_t)size);
	buffer_put(buffer, text, size);
}

struct bytes buffer_bytes(const struct buffer *buffer)
{
	return (struct bytes){ buffer->data, buffer->size };
}

void reader_init(struct reader *reader, struct bytes bytes)
{
	*reader = (struct reader){ .data = bytes.data, .size = bytes.size };
}

size_t reader_left(const struct reader *reader)
{
	return reader->failed ? 0 : reader->size - reader->at;
}

struct bytes reader_bytes(struct reader *reader, size_t size)
{
	struct bytes view;

	if (reader->failed || size > reader->size - reader->at) {
		reader->failed = true;
		return (struct bytes){ NULL, 0 };
	}
	view = (struct bytes){ size ? reader->data + reader->at : NULL, size };
	reader->at += size;
	return view;
}

static uint64_t get_le(struct reader *reader, size_t size)
{
	struct bytes view = reader_bytes(reader, size);
	uint64_t value = 0;

	for (size_t i = 0; i < view.size; i++)
		value |= (uint64_t)view.data[i] << (8 * i);
	return value;
}

uint8_t reader_u8(struct reader *reader)
{
	return (uint8_t)get_le(reader, 1);
}

uint16_t reader_u16(struct reader *reader)
{
	return (uint16_t)get_le(reader, 2);
}

uint32_t reader_u32(struct reader *reader)
{
	return (uint32_t)get_le(reader, 4);
}

uint64_t reader_u64(struct reader *reader)
{
	return get_le(reader, 8);
}

float reader_f32(struct reader *reader)
{
	uint32_t bits = reader_u32(reader);
	float value;

	memcpy(&value, &bits, sizeof(value));
	return value;
}

double reader_f64(struct reader *reader)
{
	uint64_t bits = reader_u64(reader);
	double value;

	memcpy(&value, &bits, sizeof(value));
	return value;
}

void reader_string(struct reader *reader, char *out, size_t out_bytes)
{
	struct bytes text = reader_bytes(reader, reader_u16(reader));

	out[0] = '\0';
	if (reader->failed)
		return;
	if (text.size >= out_bytes || (text.size && memchr(text.data, '\0', text.size))) {
		reader->failed = true;
		return;
	}
	if (text.size)
		memcpy(out, text.data, text.size);
	out[text.size] = '\0';
}

int buffer_read_fd(struct buffer *out, int fd)
{
	const off_t at = fd < 0 ? 0 : lseek(fd, 0, SEEK_CUR); /* negative for a pipe */
	uint8_t chunk[65536];
	struct stat info;
	ssize_t got;
	int rc;

	buffer_clear(out);
	if (fd < 0)
		return fd;
	if (fstat(fd, &info) == 0 && info.st_size > at &&
	    (uint64_t)(info.st_size - (at > 0 ? at : 0)) > out->ceiling) {
		close(fd);
		return -EFBIG;
	}
	while ((got = read(fd, chunk, sizeof(chunk))) != 0) {
		if (got < 0 && errno == EINTR)
			continue;
		if (got < 0)
			break;
		buffer_put(out, chunk, (size_t)got);
		if (out->error)
			break;
	}
	rc = got < 0 ? -errno : out->error;
	close(fd);
	return rc;
}

int buffer_read_file(struct buffer *out, const char *path)
{
	return buffer_read_fd(out, open_regular(path));
}

int buffer_read_beneath(struct buffer *out, const char *folder, const char *name)
{
	return buffer_read_fd(out, open_beneath(folder, name));
}

int buffer_read_foreign(struct buffer *out, const char *path)
{
	const char *slash = strrchr(path, '/');
	char folder[BYTES_PATH_MAX];

	if (!slash)
		return buffer_read_beneath(out, "", path);
	if (slash - path + 1 >= BYTES_PATH_MAX)
		return -ENAMETOOLONG;
	snprintf(folder, sizeof(folder), "%.*s", (int)(slash - path) + 1, path);
	return buffer_read_beneath(out, folder, slash + 1);
}

int bytes_write_to(int fd, struct bytes bytes)
{
	size_t done = 0;

	while (done < bytes.size) {
		ssize_t put = write(fd, bytes.data + done, bytes.size - done);
		if (put < 0 && errno != EINTR)
			return -errno;
		if (put > 0)
			done += (size_t)put;
	}
	return 0;
}

int bytes_fill_file(int fd, struct bytes bytes)
{
	const int rc = bytes_write_to(fd, bytes);

	return rc == 0 && fsync(fd) < 0 ? -errno : rc;
}

int bytes_sync_folder_of(const char *path)
{
	char copy[PATH_MAX];
	int fd, rc;

	snprintf(copy, sizeof(copy), "%s", path);
	fd = open(dirname(copy), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	if (fd < 0)
		return -errno;
	rc = fsync(fd) < 0 ? -errno : 0;
	close(fd);
	return rc;
}

int bytes_read_at(int fd, void *to, size_t size, uint64_t at)
{
	size_t done = 0;

	while (done < size) {
		ssize_t got = pread(fd, (uint8_t *)to + done, size - done, (off_t)(at + done));

		if (got < 0 && errno != EINTR)
			return -errno;
		if (got == 0)
			return -EBADMSG;
		if (got > 0)
			done += (size_t)got;
	}
	return 0;
}

int bytes_begin_file(char temporary[BYTES_PATH_MAX], const char *path)
{
	int fd;

	if (snprintf(temporary, BYTES_PATH_MAX, "%s.XXXXXX", path) >= BYTES_PATH_MAX)
		return -ENAMETOOLONG;
	fd = mkostemp(temporary, O_CLOEXEC);
	return fd < 0 ? -errno : fd;
}

int bytes_end_file(int fd, const char *temporary, const char *path, int rc)
{
	if (fchmod(fd, 0644) < 0 && rc == 0)
		rc = -errno;
	if (close(fd) < 0 && rc == 0)
		rc = -errno;
	if (rc == 0 && rename(temporary, path) < 0)
		rc = -errno;
	if (rc < 0)
		unlink(temporary);
	return rc;
}

int bytes_write_file(struct bytes bytes, const char *path)
{
	char temporary[BYTES_PATH_MAX];
	int fd = bytes_begin_file(temporary, path), rc;

	if (fd < 0)
		return fd;
	rc = bytes_end_file(fd, temporary, path, bytes_fill_file(fd, bytes));
	return rc < 0 ? rc : bytes_sync_folder_of(path);
}

/* Returns whether entry is a temporary file as mkostemp names it, "state.db.second.a1B2c3" for
 * "state.db.second", and sets *length to that of the name. */
static bool is_leftover(const char *entry, size_t *length)
{
	const char *end = strrchr(entry, '.');

	if (!end || strlen(end + 1) != 6)
		return false;
	*length = (size_t)(end - entry);
	for (end++; isalnum((unsigned char)*end); end++)
		;
	return *end == '\0';
}

void bytes_drop_leftovers(const char *path)
{
	char folder[BYTES_PATH_MAX];
	const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
	struct dirent *entry;
	DIR *entries;
	size_t length;

	snprintf(folder, sizeof(folder), "%.*s", slash ? (int)(slash - path) + 1 : 1,
		 slash ? path : ".");
	entries = opendir(folder);
	while (entries && (entry = readdir(entries)))
		if (is_leftover(entry->d_name, &length) && length == strlen(name) &&
		    memcmp(entry->d_name, name, length) == 0)
			unlinkat(dirfd(entries), entry->d_name, 0);
	if (entries)
		closedir(entries);
}

void bytes_sweep_folder(const char *folder, int64_t before_s)
{
	DIR *entries = opendir(folder);
	struct dirent *entry;
	struct stat status;
	size_t length;

	while (entries && (entry = readdir(entries)))
		if (is_leftover(entry->d_name, &length) &&
		    fstatat(dirfd(entries), entry->d_name, &status, AT_SYMLINK_NOFOLLOW) == 0 &&
		    S_ISREG(status.st_mode) && status.st_mtim.tv_sec < before_s)
			unlinkat(dirfd(entries), entry->d_name, 0);
	if (entries)
		closedir(entries);
}

void bytes_remove_folder(const char *path)
{
	DIR *entries = opendir(path);
	struct dirent *entry;

	while (entries && (entry = readdir(entries)))
		if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0)
			unlinkat(dirfd(entries), entry->d_name, 0);
	if (entries)
		closedir(entries);
	if (unlink(path) < 0)
		rmdir(path);
}
