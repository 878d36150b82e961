/* Wraps SQLite for the modules of this folder: opens databases, translates errors, sets a damaged
 * database aside. */
#ifndef GOPURA_STORAGE_DB_H
#define GOPURA_STORAGE_DB_H

#include <sqlite3.h>
#include <stdbool.h>

#include "base/compiler.h"

/* Translates a result code: 0 for SQLITE_OK, ROW and DONE; -EBADMSG: the file is damaged or not a
 * database; -ENOSPC: disk full or page limit reached; -ENOMEM; -EROFS; -EBUSY; -EIO: anything else.
 * Does not log. */
must_check int db_code(int code);
/* As db_code, and logs the error. db may be NULL. */
must_check int db_error(sqlite3 *db, int code, const char *doing);

/* Returns whether a read of the open database or its log has failed in the system: SQLite calls a
 * page damaged then (SQLITE_IOERR_CORRUPTFS) that may be read the next time. NULL: false. */
bool db_read_failed(sqlite3 *db);

/* Opens or creates a database for one thread of this process only (exclusive locking). On failure
 * *out is NULL. Returns errors as db_code. */
must_check int db_open(sqlite3 **out, const char *path);
/* Runs each statement of sql. Does not log: the caller decides what a failure means. */
must_check int db_exec(sqlite3 *db, const char *sql);
/* Steps a statement that gives no rows, and resets it. Does not log. */
must_check int db_run(sqlite3_stmt *statement);
/* Gives the single integer of sql; -1 on failure. -ENOENT: there is no row. Does not log. */
int db_integer(sqlite3 *db, const char *sql, sqlite3_int64 *out);

/* Renames path to path.broken (replacing an earlier one) and cuts it to most_bytes, so that a
 * damaged cache does not take a second budget. Removes its -wal, -shm and -journal. The database
 * must be closed. Returns 0 if there is no such file, or a negative errno. */
must_check int db_set_aside(const char *path, long most_bytes);

#endif
