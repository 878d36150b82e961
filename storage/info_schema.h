/* Private to storage: what both sides of the information database agree on. */
#ifndef GOPURA_STORAGE_INFO_SCHEMA_H
#define GOPURA_STORAGE_INFO_SCHEMA_H

enum {
	INFO_APPLICATION_ID = 0x47704966, /* "GpIf", in the SQLite header */
	INFO_SCHEMA_VERSION = 1,          /* user_version; another one is refused */
};

#endif
