/* The one door to SQLite for the modules of this folder: opens, translates errors, sets a damaged
 * database aside. */
#ifndef GOPURA_STORAGE_DB_H
#define GOPURA_STORAGE_DB_H

#include <sqlite3.h>
#include <stdbool.h>

#include "base/compiler.h"

/* 0 for SQLITE_OK, ROW and DONE; -EBADMSG: the file is damaged or no database; -ENOSPC: disk full
 * or past its page ceiling; -ENOMEM; -EROFS; -EIO: anything else. Says nothing. */
must_check int db_code(int code);
/* As db_code, and logs what went wrong. db may be NULL. */
must_check int db_error(sqlite3 *db, int code, const char *doing);

/* Opens or creates path for one thread of this process and nobody else (exclusive locking). On
 * failure *out is NULL. */
must_check int db_open(sqlite3 **out, const char *path);
/* Runs each statement of sql. Silent: the caller decides what a failure means. */
must_check int db_exec(sqlite3 *db, const char *sql);
/* Steps a statement that gives no rows, and resets it. Silent. */
must_check int db_run(sqlite3_stmt *statement);
/* The single integer that sql gives; on failure (or no row) -1. */
sqlite3_int64 db_integer(sqlite3 *db, const char *sql);

/* Renames path to path.broken (replacing an earlier one), cut to most_bytes so that a damaged cache
 * costs no second budget, and removes its -wal, -shm and -journal. The database must be closed. */
must_check int db_set_aside(const char *path, long most_bytes);

#endif
