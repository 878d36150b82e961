/* The struct that the sources of the cache share: cache_file.c opens the file and handles damage,
 * cache_room.c keeps the budget, cache.c has the calls. */
#ifndef GOPURA_STORAGE_CACHE_PRIVATE_H
#define GOPURA_STORAGE_CACHE_PRIVATE_H

#include "storage/cache.h"
#include "storage/db.h"

enum {
	CACHE_PAGE_BYTES = 4096,
	CACHE_EXTRA_PAGES =
		6, /* pages that a row costs beside its own: tree, two indexes, free list */
};

enum statement {
	STATEMENT_BEGIN,
	STATEMENT_COMMIT,
	STATEMENT_GET,
	STATEMENT_TOUCH,
	STATEMENT_PUT,
	STATEMENT_DROP,
	STATEMENT_MIN,
	STATEMENT_IS_KEPT,
	STATEMENT_KEEP,
	STATEMENT_MARK_KEPT,
	STATEMENT_KEPT_BYTES,
	STATEMENT_GET_FILE,
	STATEMENT_PUT_FILE,
	STATEMENT_FREE_PAGES,
	STATEMENT_PAGES,
	STATEMENT_TICK,
	STATEMENT_COUNT,
};

struct cache {
	char *path;
	uint64_t budget_bytes, log_bytes;
	sqlite3 *db; /* NULL: it could not be opened */
	sqlite3_stmt *statements[STATEMENT_COUNT];
	int64_t retry_at_ms;    /* time of the next try to open, while db is NULL */
	int64_t complain_at_ms; /* no warning before this time */
	int64_t opened_ms;
	int64_t first_tick; /* seconds of use before the file was opened */
	bool in_batch;
	uint64_t batch_pages; /* changed since BEGIN, overestimated */
	int log_pages;        /* in the write-ahead log, as its hook reported */
	int faults;           /* failed reads since the last success */
	bool has_lost;        /* something that was to be stored is not; cache_sync has to say so */
	struct cache_figures figures;
};

#endif
