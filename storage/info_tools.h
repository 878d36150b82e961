/* The tools that the content offers to visitors, in the information database. */
#ifndef GOPURA_STORAGE_INFO_TOOLS_H
#define GOPURA_STORAGE_INFO_TOOLS_H

#include "storage/info.h"

/* Viewing tools that the content offers to visitors, one bit each: docs/tools.md. */
enum info_tool {
	INFO_TOOL_LIGHT = 1,
	INFO_TOOL_SECTION = 2,
	INFO_TOOL_MEASURE = 4,
	INFO_TOOL_WALK = 8,
};
/* Returns the tool of a name ("light", "section", "measure" or "walk"); 0: none of them. */
unsigned info_tool_named(const char *name, size_t length);

/* Returns the tools that the content offers, a mask of enum info_tool; unknown ones are left
 * out. */
unsigned info_tools(const struct info *info);

/* Returns how far a point of the scan may be from the real surface, in metres, as the content says
 * it for measuring; 0 without that tool. */
float info_scan_error_m(const struct info *info);

/* For opening: reads the table of tools, which may exist in any version. */
must_check int info_load_tools(struct info *info);

#endif
