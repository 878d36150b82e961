/* Rows of an information database, with everything checked that a stranger may have written: UTF-8,
 * no zero bytes in texts, finite numbers. */
#include "storage/info_rows.h"

#include <errno.h>
#include <glib.h>
#include <math.h>
#include <string.h>

#include "base/log.h"

int info_from_sqlite(sqlite3 *db, int code, const char *doing)
{
	switch (code) {
	case SQLITE_OK:
	case SQLITE_ROW:
	case SQLITE_DONE:
		return 0;
	case SQLITE_NOMEM:
		return -ENOMEM;
	default:
		log_error("storage", "information database: %s: %s", doing, sqlite3_errmsg(db));
		return -EBADMSG;
	}
}

int info_each_row(struct info *info, const char *sql, info_row_reader *read)
{
	sqlite3_stmt *statement = NULL;
	int code = sqlite3_prepare_v2(info->db, sql, -1, &statement, NULL);
	int rc = info_from_sqlite(info->db, code, sql);

	while (rc == 0 && (code = sqlite3_step(statement)) == SQLITE_ROW)
		rc = read(info, statement);
	if (rc == 0)
		rc = info_from_sqlite(info->db, code, sql);
	sqlite3_finalize(statement);
	return rc;
}

int info_copy_text(sqlite3_stmt *row, int column, char **out)
{
	const char *text = (const char *)sqlite3_column_text(row, column);
	int size = sqlite3_column_bytes(row, column);

	if (!text)
		return sqlite3_column_type(row, column) == SQLITE_NULL ? 0 : -ENOMEM;
	if (!g_utf8_validate(text, size, NULL))
		return -EBADMSG;
	*out = strdup(text);
	return *out ? 0 : -ENOMEM;
}

static int read_float(sqlite3_stmt *row, int column, float *out)
{
	*out = (float)sqlite3_column_double(row, column);
	return isfinite(*out) ? 0 : -EBADMSG;
}

int info_read_floats(sqlite3_stmt *row, int column, float *out, int count)
{
	int rc = 0;

	for (int i = 0; i < count && rc == 0; i++)
		rc = read_float(row, column + i, &out[i]);
	return rc;
}
