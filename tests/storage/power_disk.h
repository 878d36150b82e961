/* A disk whose power can go at any moment. While it records, every write, truncation, sync, new
 * name and lost name of the files in a folder is noted: SQLite's through a file system of its own
 * that lies over the real one, those of base/bytes.c at the linker (-Wl,--wrap). Afterwards
 * power_disk_make puts a folder as the disk may be after a cut: what was synced is there, and of
 * what was not any part.
 *
 * What a sync promises is what ext4, XFS and btrfs do: of a file, its bytes, its size and that it
 * is there under the name it was made with; of a folder, every name in it. A sector of 512 bytes is
 * written wholly or not. */
#ifndef GOPURA_TESTS_POWER_DISK_H
#define GOPURA_TESTS_POWER_DISK_H

#include <fcntl.h>
#include <limits.h>
#include <sqlite3.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/check.h"

enum { POWER_FILES_MAX = 512, POWER_NAME_BYTES = 64, POWER_SECTOR_BYTES = 512 };

enum power_kind {
	POWER_CREATE, /* file, under the name */
	POWER_WRITE,
	POWER_TRUNCATE, /* to `at` bytes */
	POWER_SYNC,
	POWER_DELETE, /* the name */
	POWER_RENAME, /* the name to `to` */
	POWER_SYNC_FOLDER,
	POWER_MARK, /* the workload was promised something: `at` tells what */
};

struct power_op {
	enum power_kind kind;
	int file;
	char name[POWER_NAME_BYTES], to[POWER_NAME_BYTES];
	size_t at, size;
	uint8_t *bytes; /* owned */
};

struct power_file {
	uint8_t *bytes; /* owned */
	size_t size, capacity;
};

/* Names and bytes. */
struct power_image {
	struct power_file files[POWER_FILES_MAX];
	char names[POWER_FILES_MAX][POWER_NAME_BYTES]; /* of each file; "": it has none */
};

static struct power_disk {
	char folder[PATH_MAX];
	bool records, swallows_syncs;
	struct power_op *ops;
	size_t op_count, op_capacity;
	int file_count;
	int file_of_fd[1024]; /* and one more; 0: none of ours */
	/* While replaying: what is on the disk for sure, and what may be. */
	struct power_image durable;
	size_t *pending; /* ops, in order */
	size_t pending_count;
} power;

/* ---- recording */

/* The name in the folder; NULL: it is elsewhere. */
static const char *power_name(const char *path)
{
	size_t length = strlen(power.folder);

	if (!power.records || strncmp(path, power.folder, length) != 0 || path[length] != '/')
		return NULL;
	return path + length + 1;
}

static struct power_op *power_note(enum power_kind kind, int file, const char *name)
{
	struct power_op *op;

	if (power.op_count == power.op_capacity) {
		power.op_capacity = power.op_capacity ? 2 * power.op_capacity : 1024;
		power.ops = realloc(power.ops, power.op_capacity * sizeof(*power.ops));
		CHECK(power.ops);
	}
	op = &power.ops[power.op_count++];
	*op = (struct power_op){ .kind = kind, .file = file };
	if (name)
		snprintf(op->name, sizeof(op->name), "%s", name);
	return op;
}

static int power_create(const char *name)
{
	CHECK(power.file_count < POWER_FILES_MAX - 1);
	power_note(POWER_CREATE, ++power.file_count, name);
	return power.file_count;
}

static void power_write(int file, const void *bytes, size_t size, size_t at)
{
	struct power_op *op = power_note(POWER_WRITE, file, NULL);

	op->at = at;
	op->size = size;
	op->bytes = malloc(size ? size : 1);
	CHECK(op->bytes);
	memcpy(op->bytes, bytes, size);
}

static void power_sync(enum power_kind kind, int file)
{
	if (!power.swallows_syncs)
		power_note(kind, file, NULL);
}

/* The workload was promised something. */
static inline void power_mark(size_t what)
{
	power_note(POWER_MARK, 0, NULL)->at = what;
}

/* ---- the calls of base/bytes.c */

int __real_mkostemp(char *path, int flags);
ssize_t __real_write(int fd, const void *bytes, size_t size);
int __real_fsync(int fd);
int __real_close(int fd);
int __real_rename(const char *from, const char *to);
int __real_unlink(const char *path);
int __wrap_mkostemp(char *path, int flags);
ssize_t __wrap_write(int fd, const void *bytes, size_t size);
int __wrap_fsync(int fd);
int __wrap_close(int fd);
int __wrap_rename(const char *from, const char *to);
int __wrap_unlink(const char *path);

static int *power_slot(int fd)
{
	static int none;

	none = 0;
	return fd >= 0 && fd < 1024 ? &power.file_of_fd[fd] : &none;
}

int __wrap_mkostemp(char *path, int flags)
{
	int fd = __real_mkostemp(path, flags);
	const char *name = power_name(path);

	if (fd >= 0 && name)
		*power_slot(fd) = power_create(name);
	return fd;
}

ssize_t __wrap_write(int fd, const void *bytes, size_t size)
{
	off_t at = *power_slot(fd) ? lseek(fd, 0, SEEK_CUR) : 0;
	ssize_t put = __real_write(fd, bytes, size);

	if (put > 0 && *power_slot(fd))
		power_write(*power_slot(fd), bytes, (size_t)put, (size_t)at);
	return put;
}

int __wrap_fsync(int fd)
{
	struct stat info;

	if (power.records && *power_slot(fd))
		power_sync(POWER_SYNC, *power_slot(fd));
	else if (power.records && fstat(fd, &info) == 0 && S_ISDIR(info.st_mode))
		power_sync(POWER_SYNC_FOLDER, 0);
	return __real_fsync(fd);
}

int __wrap_close(int fd)
{
	*power_slot(fd) = 0;
	return __real_close(fd);
}

int __wrap_rename(const char *from, const char *to)
{
	int rc = __real_rename(from, to);
	const char *name = power_name(from);

	if (rc == 0 && name)
		snprintf(power_note(POWER_RENAME, 0, name)->to, POWER_NAME_BYTES, "%s",
			 power_name(to));
	return rc;
}

int __wrap_unlink(const char *path)
{
	int rc = __real_unlink(path);
	const char *name = power_name(path);

	if (rc == 0 && name)
		power_note(POWER_DELETE, 0, name);
	return rc;
}

/* ---- SQLite's */

struct power_handle {
	sqlite3_file base;
	int file;           /* 0: not recorded */
	sqlite3_file *real; /* behind this struct */
};

static sqlite3_vfs *power_real_vfs;
static sqlite3_vfs power_vfs;

static sqlite3_file *power_real(sqlite3_file *file)
{
	return ((struct power_handle *)file)->real;
}

static int power_file_of(sqlite3_file *file)
{
	return power.records ? ((struct power_handle *)file)->file : 0;
}

static int power_x_close(sqlite3_file *file)
{
	return power_real(file)->pMethods->xClose(power_real(file));
}

static int power_x_read(sqlite3_file *file, void *to, int size, sqlite3_int64 at)
{
	return power_real(file)->pMethods->xRead(power_real(file), to, size, at);
}

static int power_x_write(sqlite3_file *file, const void *from, int size, sqlite3_int64 at)
{
	if (power_file_of(file))
		power_write(power_file_of(file), from, (size_t)size, (size_t)at);
	return power_real(file)->pMethods->xWrite(power_real(file), from, size, at);
}

static int power_x_truncate(sqlite3_file *file, sqlite3_int64 size)
{
	if (power_file_of(file))
		power_note(POWER_TRUNCATE, power_file_of(file), NULL)->at = (size_t)size;
	return power_real(file)->pMethods->xTruncate(power_real(file), size);
}

static int power_x_sync(sqlite3_file *file, int flags)
{
	(void)flags; /* the test machine's power stays on */
	if (power_file_of(file))
		power_sync(POWER_SYNC, power_file_of(file));
	return SQLITE_OK;
}

static int power_x_size(sqlite3_file *file, sqlite3_int64 *size)
{
	return power_real(file)->pMethods->xFileSize(power_real(file), size);
}

static int power_x_lock(sqlite3_file *file, int level)
{
	return power_real(file)->pMethods->xLock(power_real(file), level);
}

static int power_x_unlock(sqlite3_file *file, int level)
{
	return power_real(file)->pMethods->xUnlock(power_real(file), level);
}

static int power_x_check_lock(sqlite3_file *file, int *out)
{
	return power_real(file)->pMethods->xCheckReservedLock(power_real(file), out);
}

static int power_x_control(sqlite3_file *file, int op, void *data)
{
	return power_real(file)->pMethods->xFileControl(power_real(file), op, data);
}

static int power_x_sector(sqlite3_file *file)
{
	return power_real(file)->pMethods->xSectorSize(power_real(file));
}

static int power_x_traits(sqlite3_file *file)
{
	return power_real(file)->pMethods->xDeviceCharacteristics(power_real(file));
}

static const sqlite3_io_methods power_methods = {
	.iVersion = 1, /* no shared memory: the modules lock exclusively */
	.xClose = power_x_close,
	.xRead = power_x_read,
	.xWrite = power_x_write,
	.xTruncate = power_x_truncate,
	.xSync = power_x_sync,
	.xFileSize = power_x_size,
	.xLock = power_x_lock,
	.xUnlock = power_x_unlock,
	.xCheckReservedLock = power_x_check_lock,
	.xFileControl = power_x_control,
	.xSectorSize = power_x_sector,
	.xDeviceCharacteristics = power_x_traits,
};

/* The file that has this name now, by the log; 0: none. */
static int power_find(const char *name)
{
	int file = 0;

	for (size_t i = 0; i < power.op_count; i++) {
		const struct power_op *op = &power.ops[i];

		if (op->kind == POWER_CREATE && strcmp(op->name, name) == 0)
			file = op->file;
		else if (op->kind == POWER_DELETE && strcmp(op->name, name) == 0)
			file = 0;
	}
	return file;
}

static int power_x_open(sqlite3_vfs *vfs, const char *name, sqlite3_file *file, int flags, int *out)
{
	struct power_handle *handle = (struct power_handle *)file;
	const char *local = name ? power_name(name) : NULL;
	int code;

	(void)vfs;
	handle->real = (sqlite3_file *)(handle + 1);
	handle->file = 0;
	if (local) {
		handle->file = power_find(local);
		if (!handle->file)
			handle->file = power_create(local);
	}
	code = power_real_vfs->xOpen(power_real_vfs, name, handle->real, flags, out);
	handle->base.pMethods = handle->real->pMethods ? &power_methods : NULL;
	return code;
}

static int power_x_delete(sqlite3_vfs *vfs, const char *name, int sync_folder)
{
	int code = power_real_vfs->xDelete(power_real_vfs, name, 0);

	(void)vfs;
	if (code == SQLITE_OK && power_name(name)) {
		power_note(POWER_DELETE, 0, power_name(name));
		if (sync_folder)
			power_sync(POWER_SYNC_FOLDER, 0);
	}
	return code;
}

static inline void power_install(void)
{
	power_real_vfs = sqlite3_vfs_find(NULL);
	power_vfs = *power_real_vfs;
	power_vfs.szOsFile += (int)sizeof(struct power_handle);
	power_vfs.zName = "power";
	power_vfs.pNext = NULL;
	power_vfs.xOpen = power_x_open;
	power_vfs.xDelete = power_x_delete;
	sqlite3_vfs_register(&power_vfs, 1);
}

/* ---- replaying */

static void power_resize(struct power_file *file, size_t size)
{
	if (size > file->capacity) {
		file->capacity = 2 * size;
		file->bytes = realloc(file->bytes, file->capacity);
		CHECK(file->bytes);
	}
	if (size > file->size)
		memset(file->bytes + file->size, 0, size - file->size);
	file->size = size;
}

static void power_put(struct power_file *file, const uint8_t *bytes, size_t size, size_t at)
{
	if (at + size > file->size)
		power_resize(file, at + size);
	memcpy(file->bytes + at, bytes, size);
}

/* At least two sectors, of which each is written or not. */
static void power_put_torn(struct power_file *file, const struct power_op *op, uint64_t mask)
{
	for (size_t at = 0, n = 0; at < op->size; at += POWER_SECTOR_BYTES, n++) {
		size_t size = op->size - at;

		if (mask >> (n % 64) & 1)
			power_put(file, op->bytes + at,
				  size < POWER_SECTOR_BYTES ? size : POWER_SECTOR_BYTES,
				  op->at + at);
	}
}

static int power_named(const struct power_image *image, const char *name)
{
	for (int i = 1; i < POWER_FILES_MAX; i++)
		if (strcmp(image->names[i], name) == 0)
			return i;
	return 0;
}

/* To "": deleted. */
static void power_rename(struct power_image *image, const char *from, const char *to)
{
	const int source = power_named(image, from), target = to[0] ? power_named(image, to) : 0;

	if (!source)
		return;
	image->names[target][0] = '\0'; /* of file 0, which nobody uses, where there is none */
	snprintf(image->names[source], POWER_NAME_BYTES, "%s", to);
}

static void power_apply(struct power_image *image, const struct power_op *op)
{
	switch (op->kind) {
	case POWER_CREATE:
		snprintf(image->names[op->file], POWER_NAME_BYTES, "%s", op->name);
		break;
	case POWER_WRITE:
		power_put(&image->files[op->file], op->bytes, op->size, op->at);
		break;
	case POWER_TRUNCATE:
		power_resize(&image->files[op->file], op->at);
		break;
	case POWER_RENAME:
	case POWER_DELETE:
		power_rename(image, op->name, op->to);
		break;
	default:
		break;
	}
}

static bool power_is_of_names(const struct power_op *op)
{
	return op->kind == POWER_CREATE || op->kind == POWER_DELETE || op->kind == POWER_RENAME;
}

/* What this sync makes sure of leaves the pending ones. */
static void power_settle(const struct power_op *sync)
{
	size_t left = 0;

	for (size_t i = 0; i < power.pending_count; i++) {
		const struct power_op *op = &power.ops[power.pending[i]];
		const bool settled = sync->kind == POWER_SYNC_FOLDER
					     ? power_is_of_names(op)
					     : op->file == sync->file && op->file != 0;

		if (settled)
			power_apply(&power.durable, op);
		else
			power.pending[left++] = power.pending[i];
	}
	power.pending_count = left;
}

static inline void power_rewind(void)
{
	for (int i = 0; i < POWER_FILES_MAX; i++)
		free(power.durable.files[i].bytes);
	memset(&power.durable, 0, sizeof(power.durable));
	free(power.pending);
	power.pending = calloc(power.op_count + 1, sizeof(*power.pending));
	CHECK(power.pending);
	power.pending_count = 0;
}

/* The n-th op was done before the power went. */
static inline void power_step(size_t n)
{
	const struct power_op *op = &power.ops[n];

	if (op->kind == POWER_SYNC || op->kind == POWER_SYNC_FOLDER)
		power_settle(op);
	else if (op->kind != POWER_MARK)
		power.pending[power.pending_count++] = n;
}

static void power_copy(struct power_image *to, const struct power_image *from)
{
	memcpy(to->names, from->names, sizeof(to->names));
	for (int i = 0; i < POWER_FILES_MAX; i++) {
		to->files[i].size = 0;
		if (from->files[i].size > 0)
			power_put(&to->files[i], from->files[i].bytes, from->files[i].size, 0);
	}
}

/* What the product may have left there; its temporary files are never made. */
static void power_empty(const char *folder)
{
	static const char *const names[] = { "state.db",         "state.db-wal",
					     "state.db-journal", "state.db.second",
					     "state.db.broken",  "cache.db",
					     "cache.db-wal",     "cache.db-journal",
					     "cache.db.broken" };
	char path[PATH_MAX + POWER_NAME_BYTES];

	for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
		snprintf(path, sizeof(path), "%s/%s", folder, names[i]);
		__real_unlink(path);
	}
}

/* Puts the disk into folder: of the pending ops those for which has(data, i) says so, the last one
 * torn where torn is not 0 (a bit a sector). */
static inline void power_disk_make(const char *folder, bool (*has)(const void *data, size_t i),
				   const void *data, uint64_t torn)
{
	static struct power_image image;

	power_copy(&image, &power.durable);
	for (size_t i = 0; i < power.pending_count; i++) {
		const struct power_op *op = &power.ops[power.pending[i]];

		if (torn != 0 && i + 1 == power.pending_count && op->kind == POWER_WRITE)
			power_put_torn(&image.files[op->file], op, torn);
		else if (has(data, i))
			power_apply(&image, op);
	}
	power_empty(folder);
	for (int i = 1; i < POWER_FILES_MAX; i++) {
		char path[PATH_MAX + POWER_NAME_BYTES];
		FILE *file;

		if (!image.names[i][0] || strstr(image.names[i], ".second."))
			continue; /* a file that was to become the second copy: nobody reads it */
		snprintf(path, sizeof(path), "%s/%s", folder, image.names[i]);
		file = fopen(path, "wb");
		CHECK(file);
		CHECK(image.files[i].size == 0 ||
		      fwrite(image.files[i].bytes, image.files[i].size, 1, file) == 1);
		CHECK(fclose(file) == 0);
	}
}

#endif
