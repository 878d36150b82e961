/* Private to storage: reads rows of an information database that is not trusted. */
#ifndef GOPURA_STORAGE_INFO_ROWS_H
#define GOPURA_STORAGE_INFO_ROWS_H

#include "storage/info_private.h"

/* Translates a result code to 0, -ENOMEM, or -EBADMSG, which is logged. */
must_check int info_from_sqlite(sqlite3 *db, int code, const char *doing);
/* Reads one row of an image that is not trusted. Returns 0 or a negative errno, which ends the
 * query. */
typedef int info_row_reader(struct info *info, sqlite3_stmt *row);
/* Runs sql and calls read for each row. */
must_check int info_each_row(struct info *info, const char *sql, info_row_reader *read);
/* Copies a text column; NULL stays NULL. Returns -EBADMSG for text with zero bytes inside or
 * invalid UTF-8, or -ENOMEM. *out is owned by the caller. */
must_check int info_copy_text(sqlite3_stmt *row, int column, char **out);
/* Reads count columns; -EBADMSG if one is not finite. */
must_check int info_read_floats(sqlite3_stmt *row, int column, float *out, int count);

#endif
