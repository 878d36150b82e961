/* A SQLite file system that fails on demand: it lies over the real one and becomes the default.
 * Every write, truncation and sync counts; from the chosen one on they fail, as on a full disk, as
 * on a dying one, or as at a power cut (that write is torn in half, and no later one happens). Or
 * it is reads that fail. */
#ifndef GOPURA_TESTS_FAULT_VFS_H
#define GOPURA_TESTS_FAULT_VFS_H

#include <errno.h>
#include <sqlite3.h>
#include <stdbool.h>
#include <string.h>
#include <unistd.h>

enum fault_kind { FAULT_NONE, FAULT_FULL, FAULT_IO, FAULT_POWER_CUT, FAULT_READ };

static struct fault {
	enum fault_kind kind;
	long at;    /* the write that fails first, from 0 */
	long count; /* writes that fail; 0: all later ones too */
	long writes;
	long reads; /* with FAULT_READ it is these that fail, and no write */
	bool fails; /* the read that is under way */
} fault;

struct fault_file {
	sqlite3_file base;
	sqlite3_file *real; /* behind this struct */
};

static sqlite3_vfs *fault_real_vfs;
static sqlite3_vfs fault_vfs;

static bool fault_strikes(bool *first)
{
	long n = fault.writes++;

	*first = n == fault.at;
	if (fault.kind == FAULT_NONE || fault.kind == FAULT_READ || n < fault.at)
		return false;
	return fault.count == 0 || n < fault.at + fault.count;
}

static int fault_code(int io_code)
{
	return fault.kind == FAULT_FULL ? SQLITE_FULL : io_code;
}

static sqlite3_file *fault_real(sqlite3_file *file)
{
	return ((struct fault_file *)file)->real;
}

static int fault_close(sqlite3_file *file)
{
	return fault_real(file)->pMethods->xClose(fault_real(file));
}

static int fault_read(sqlite3_file *file, void *to, int size, sqlite3_int64 at)
{
	const long n = fault.reads++;
	int code;

	fault.fails = fault.kind == FAULT_READ && n >= fault.at && n < fault.at + fault.count;
	code = fault_real(file)->pMethods->xRead(fault_real(file), to, size, at);
	fault.fails = false;
	return code;
}

/* The system call itself, because what SQLite makes of its errno matters. */
static ssize_t fault_pread(int fd, void *to, size_t size, off64_t at)
{
	if (!fault.fails)
		return pread64(fd, to, size, at);
	errno = EIO;
	return -1;
}

static int fault_write(sqlite3_file *file, const void *from, int size, sqlite3_int64 at)
{
	bool first;

	if (fault_strikes(&first)) {
		if (fault.kind == FAULT_POWER_CUT && first)
			fault_real(file)->pMethods->xWrite(fault_real(file), from, size / 2, at);
		return fault_code(SQLITE_IOERR_WRITE);
	}
	return fault_real(file)->pMethods->xWrite(fault_real(file), from, size, at);
}

static int fault_truncate(sqlite3_file *file, sqlite3_int64 size)
{
	bool first;

	if (fault_strikes(&first))
		return fault_code(SQLITE_IOERR_TRUNCATE);
	return fault_real(file)->pMethods->xTruncate(fault_real(file), size);
}

static int fault_sync(sqlite3_file *file, int flags)
{
	bool first;

	(void)file; /* the test machine's power stays on */
	(void)flags;
	return fault_strikes(&first) ? fault_code(SQLITE_IOERR_FSYNC) : SQLITE_OK;
}

static int fault_size(sqlite3_file *file, sqlite3_int64 *size)
{
	return fault_real(file)->pMethods->xFileSize(fault_real(file), size);
}

static int fault_lock(sqlite3_file *file, int level)
{
	return fault_real(file)->pMethods->xLock(fault_real(file), level);
}

static int fault_unlock(sqlite3_file *file, int level)
{
	return fault_real(file)->pMethods->xUnlock(fault_real(file), level);
}

static int fault_check_lock(sqlite3_file *file, int *out)
{
	return fault_real(file)->pMethods->xCheckReservedLock(fault_real(file), out);
}

static int fault_control(sqlite3_file *file, int op, void *data)
{
	return fault_real(file)->pMethods->xFileControl(fault_real(file), op, data);
}

static int fault_sector(sqlite3_file *file)
{
	return fault_real(file)->pMethods->xSectorSize(fault_real(file));
}

static int fault_traits(sqlite3_file *file)
{
	return fault_real(file)->pMethods->xDeviceCharacteristics(fault_real(file));
}

static const sqlite3_io_methods fault_methods = {
	.iVersion = 1, /* no shared memory: the modules lock exclusively */
	.xClose = fault_close,
	.xRead = fault_read,
	.xWrite = fault_write,
	.xTruncate = fault_truncate,
	.xSync = fault_sync,
	.xFileSize = fault_size,
	.xLock = fault_lock,
	.xUnlock = fault_unlock,
	.xCheckReservedLock = fault_check_lock,
	.xFileControl = fault_control,
	.xSectorSize = fault_sector,
	.xDeviceCharacteristics = fault_traits,
};

static int fault_open(sqlite3_vfs *vfs, const char *name, sqlite3_file *file, int flags, int *out)
{
	struct fault_file *wrapped = (struct fault_file *)file;
	int code;

	(void)vfs;
	wrapped->real = (sqlite3_file *)(wrapped + 1);
	code = fault_real_vfs->xOpen(fault_real_vfs, name, wrapped->real, flags, out);
	wrapped->base.pMethods = wrapped->real->pMethods ? &fault_methods : NULL;
	return code;
}

static int fault_delete(sqlite3_vfs *vfs, const char *name, int sync_folder)
{
	bool first;

	(void)vfs;
	if (fault_strikes(&first))
		return fault_code(SQLITE_IOERR_DELETE);
	return fault_real_vfs->xDelete(fault_real_vfs, name, sync_folder);
}

static void fault_install(void)
{
	fault_real_vfs = sqlite3_vfs_find(NULL);
	fault_vfs = *fault_real_vfs;
	fault_vfs.szOsFile += (int)sizeof(struct fault_file);
	fault_vfs.zName = "fault";
	fault_vfs.pNext = NULL;
	fault_vfs.xOpen = fault_open;
	fault_vfs.xDelete = fault_delete;
	sqlite3_vfs_register(&fault_vfs, 1);
	fault_real_vfs->xSetSystemCall(fault_real_vfs, "pread",
				       (sqlite3_syscall_ptr)(void *)fault_pread);
	fault_real_vfs->xSetSystemCall(fault_real_vfs, "pread64",
				       (sqlite3_syscall_ptr)(void *)fault_pread);
}

static void fault_set(enum fault_kind kind, long at, long count)
{
	fault = (struct fault){ .kind = kind, .at = at, .count = count };
}

#endif
