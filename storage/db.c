/* Opens SQLite databases with safe settings, translates result codes, and renames damaged files. */
#include "storage/db.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/log.h"

int db_code(int code)
{
	switch (code & 0xff) {
	case SQLITE_OK:
	case SQLITE_ROW:
	case SQLITE_DONE:
		return 0;
	case SQLITE_CORRUPT:
	case SQLITE_NOTADB:
	case SQLITE_FORMAT:
	case SQLITE_MISMATCH: /* a rowid mismatch: a page was overwritten */
		return -EBADMSG;
	case SQLITE_FULL:
		return -ENOSPC;
	case SQLITE_NOMEM:
		return -ENOMEM;
	case SQLITE_READONLY:
		return -EROFS;
	case SQLITE_BUSY:
	case SQLITE_LOCKED:
		return -EBUSY;
	default:
		return -EIO;
	}
}

int db_error(sqlite3 *db, int code, const char *doing)
{
	int rc = db_code(code);

	if (rc < 0)
		log_error("storage", "%s: %s", doing,
			  db ? sqlite3_errmsg(db) : sqlite3_errstr(code));
	return rc;
}

bool db_read_failed(sqlite3 *db)
{
	sqlite3_file *log = NULL;
	int of_file = 0, of_log = 0;

	if (!db)
		return false;
	(void)sqlite3_file_control(db, NULL, SQLITE_FCNTL_LAST_ERRNO, &of_file);
	if (sqlite3_file_control(db, NULL, SQLITE_FCNTL_JOURNAL_POINTER, &log) == SQLITE_OK &&
	    log && log->pMethods)
		(void)log->pMethods->xFileControl(log, SQLITE_FCNTL_LAST_ERRNO, &of_log);
	return of_file != 0 || of_log != 0;
}

int db_open(sqlite3 **out, const char *path)
{
	int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX |
		    SQLITE_OPEN_EXRESCODE;
	int code = sqlite3_open_v2(path, out, flags, NULL);

	/* Set before the first read: with exclusive locking, WAL needs no shared-memory file. */
	if (code == SQLITE_OK)
		code = sqlite3_exec(*out, "PRAGMA locking_mode=EXCLUSIVE", NULL, NULL, NULL);
	/* Nothing in the schema of a damaged or planted file may execute. */
	if (code == SQLITE_OK)
		code = sqlite3_db_config(*out, SQLITE_DBCONFIG_DEFENSIVE, 1, NULL);
	if (code == SQLITE_OK)
		code = sqlite3_db_config(*out, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, NULL);
	if (code != SQLITE_OK) {
		sqlite3_close_v2(*out);
		*out = NULL;
	}
	return db_code(code);
}

int db_exec(sqlite3 *db, const char *sql)
{
	return db_code(sqlite3_exec(db, sql, NULL, NULL, NULL));
}

int db_run(sqlite3_stmt *statement)
{
	int code = sqlite3_step(statement);

	sqlite3_reset(statement);
	return db_code(code);
}

int db_integer(sqlite3 *db, const char *sql, sqlite3_int64 *out)
{
	sqlite3_stmt *statement = NULL;
	int code = sqlite3_prepare_v2(db, sql, -1, &statement, NULL);

	*out = -1;
	if (code == SQLITE_OK)
		code = sqlite3_step(statement);
	if (code == SQLITE_ROW)
		*out = sqlite3_column_int64(statement, 0);
	sqlite3_finalize(statement);
	return code == SQLITE_ROW ? 0 : code == SQLITE_DONE ? -ENOENT : db_code(code);
}

int db_set_aside(const char *path, long most_bytes)
{
	static const char *const beside[] = { "-wal", "-shm", "-journal" };
	char name[PATH_MAX];
	struct stat info;

	for (size_t i = 0; i < ARRAY_COUNT(beside); i++) {
		snprintf(name, sizeof(name), "%s%s", path, beside[i]);
		if (unlink(name) < 0 && errno != ENOENT)
			return -errno;
	}
	snprintf(name, sizeof(name), "%s.broken", path);
	if (rename(path, name) < 0)
		return errno == ENOENT ? 0 : -errno;
	if (stat(name, &info) == 0 && info.st_size > most_bytes && truncate(name, most_bytes) < 0)
		return -errno;
	return 0;
}
