/* What the parts of the cache share: cache_file.c opens the file and meets its damage, cache_room.c
 * keeps the budget, cache.c is the calls. */
#ifndef GOPURA_STORAGE_CACHE_PRIVATE_H
#define GOPURA_STORAGE_CACHE_PRIVATE_H

#include "storage/cache.h"
#include "storage/db.h"

enum {
	CACHE_PAGE_BYTES = 4096,
	CACHE_EXTRA_PAGES = 6, /* that a row costs beside its own: tree, two indexes, free list */
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
	sqlite3 *db; /* NULL: could not be opened */
	sqlite3_stmt *statements[STATEMENT_COUNT];
	int64_t retry_at_ms;    /* of opening, while db is NULL */
	int64_t complain_at_ms; /* not before */
	int64_t opened_ms;
	int64_t first_tick; /* seconds of use before this opening */
	bool in_batch;
	uint64_t batch_pages; /* dirtied since BEGIN, overestimated */
	int log_pages;        /* in the write-ahead log, as its hook said */
	int faults;           /* reads that failed since one succeeded */
	struct cache_figures figures;
};

/* -- cache_file.c */

/* True when there is an open database; tries to open one now and then. */
bool cache_ready(struct cache *cache);
void cache_close(struct cache *cache);
/* Every result of SQLite passes here: logs, notices a lost transaction, starts over when the file
 * is damaged (then statements are new ones: look them up again). Gives the error to return. */
must_check int cache_judge(struct cache *cache, int rc, const char *doing);
must_check int cache_set_pragmas(struct cache *cache);
/* The single integer a statement gives; -1 on failure. */
int64_t cache_integer(struct cache *cache, enum statement which);

/* -- cache_room.c */

must_check int cache_begin(struct cache *cache); /* a transaction, unless in one */
/* Ends the transaction where that many more dirty pages would make it too long. */
must_check int cache_reserve_pages(struct cache *cache, int64_t pages);
/* Notes that pages were dirtied; ends a transaction grown too long. */
must_check int cache_count_pages(struct cache *cache, int64_t pages);
/* Evicts until that many pages are free, in a transaction then. -ENOSPC: the rest is kept. */
must_check int cache_make_room(struct cache *cache, int64_t pages);
int64_t cache_free_pages(struct cache *cache);
int64_t cache_tick(const struct cache *cache); /* seconds of use */
/* Gives pages back to the disk where the file is larger than the budget now is. */
void cache_shrink(struct cache *cache);

#endif
