/* Private to storage: what both sides of the information database agree on. */
#ifndef GOPURA_STORAGE_INFO_SCHEMA_H
#define GOPURA_STORAGE_INFO_SCHEMA_H

enum {
	INFO_APPLICATION_ID = 0x47704966, /* "GpIf", in the SQLite header */
	INFO_SCHEMA_VERSION = 3,          /* user_version, as info_build writes it with tours */
	INFO_SCHEMA_TOURLESS = 2,         /* and without */
	INFO_SCHEMA_OLDEST = 1,           /* that info_open still reads; docs/information.md */
};

/* A bit each of enum info_tool, in this order. */
enum { INFO_TOOL_NAMES = 2 };
extern const char *const info_tool_names[INFO_TOOL_NAMES];

#endif
