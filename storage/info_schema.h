/* What reader and writer of the information database must agree on. Private to storage. */
#ifndef GOPURA_STORAGE_INFO_SCHEMA_H
#define GOPURA_STORAGE_INFO_SCHEMA_H

enum {
	INFO_APPLICATION_ID = 0x47704966, /* "GpIf", in the SQLite header */
	INFO_SCHEMA_VERSION = 4,          /* user_version of what is written */
	INFO_SCHEMA_ARTICLES = 4,         /* first version whose pages are articles, not HTML */
	INFO_SCHEMA_TOURS = 3,            /* first version with tours */
	INFO_SCHEMA_SEARCH = 2,           /* first version with credits, readings and an index */
	INFO_SCHEMA_OLDEST = 1, /* oldest that info_open still reads; docs/information.md */
};

/* Names of the bits of enum info_tool, in this order. */
enum { INFO_TOOL_NAMES = 4 };
extern const char *const info_tool_names[INFO_TOOL_NAMES];

#endif
