/* What the sources of the cache share: cache_file.c opens the file and handles damage, cache_room.c
 * keeps the budget, cache.c has the calls. */
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
	struct cache_figures figures;
};

/* -- cache_file.c */

/* Returns true if a database is open; tries to open one from time to time. */
bool cache_ready(struct cache *cache);
/* Closes the database and resets the state that depends on it. */
void cache_close(struct cache *cache);
/* Handles every result of SQLite: logs, notices a lost transaction, and starts over if the file is
 * damaged (then the statements are new ones: look them up again). Returns the error to pass on. */
must_check int cache_judge(struct cache *cache, int rc, const char *doing);
/* Sets page size, journal mode and limits. */
must_check int cache_set_pragmas(struct cache *cache);
/* Returns the single integer that a statement gives; -1 on failure. */
int64_t cache_integer(struct cache *cache, enum statement which);

/* -- cache_room.c */

must_check int cache_begin(struct cache *cache); /* begins a transaction if none is open */
/* Ends the transaction if that many more changed pages would make it too long. */
must_check int cache_reserve_pages(struct cache *cache, int64_t pages);
/* Counts changed pages, and ends a transaction that has become too long. */
must_check int cache_count_pages(struct cache *cache, int64_t pages);
/* Evicts until that many pages are free; a transaction is then open. Returns -ENOSPC if everything
 * that is left is kept. */
must_check int cache_make_room(struct cache *cache, int64_t pages);
/* Returns how many pages may still be written within the budget. */
int64_t cache_free_pages(struct cache *cache);
int64_t cache_tick(const struct cache *cache); /* seconds of use */
/* Returns pages to the disk if the file is larger than the budget now allows. */
void cache_shrink(struct cache *cache);

#endif
