/* Reads which tools the content offers to visitors. They have their own table, which exists only if
 * there are any. Programs that know no tools never read it, and the schema version stays the same
 * for them. */
#include "storage/info_tools.h"

#include <errno.h>
#include <string.h>

#include "storage/info_rows.h"
#include "storage/info_schema.h"

const char *const info_tool_names[INFO_TOOL_NAMES] = { "light", "section", "measure", "walk" };

unsigned info_tool_named(const char *name, size_t length)
{
	for (unsigned i = 0; i < INFO_TOOL_NAMES; i++)
		if (strlen(info_tool_names[i]) == length &&
		    memcmp(info_tool_names[i], name, length) == 0)
			return 1u << i;
	return 0;
}

static int note_table(struct info *info, sqlite3_stmt *row)
{
	(void)row;
	info->has_tools = true;
	return 0;
}

static int read_tool(struct info *info, sqlite3_stmt *row)
{
	const char *name = (const char *)sqlite3_column_text(row, 0);

	info->tools |= name ? info_tool_named(name, strlen(name)) : 0;
	return 0;
}

static int read_error(struct info *info, sqlite3_stmt *row)
{
	int rc = info_read_floats(row, 0, &info->scan_error_m, 1);

	return rc == 0 && info->scan_error_m < 0 ? -EBADMSG : rc;
}

int info_load_tools(struct info *info)
{
	int rc = info_each_row(info,
			       "SELECT 1 FROM sqlite_schema WHERE type = 'table' AND name = 'tool'",
			       note_table);

	if (rc == 0 && info->has_tools)
		rc = info_each_row(info, "SELECT name FROM tool", read_tool);
	if (rc == 0 && info->tools & INFO_TOOL_MEASURE)
		rc = info_each_row(info, "SELECT error_m FROM tool WHERE name = 'measure'",
				   read_error);
	return rc;
}

unsigned info_tools(const struct info *info)
{
	return info->tools;
}

float info_scan_error_m(const struct info *info)
{
	return info->scan_error_m;
}
