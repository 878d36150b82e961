/* Keeps the cache within its budget: transactions, checkpoints of the log, eviction and
 * shrinking. */
#include "storage/cache_room.h"

#include <errno.h>
#include <stdio.h>

#include "base/clock.h"
#include "storage/cache_file.h"

/* How the budget is kept. It is split once, into the database file and its write-ahead log:
 *
 *   log       an eighth, at most LOG_BYTES_MAX. A transaction is ended when the pages it changed,
 *             overestimated, reach a quarter of that or BATCH_BYTES_MAX. The log is written back
 *             into the database as soon as it is more than half full. While that fails, no further
 *             write is accepted.
 *   database  the rest, as SQLite's own max_page_count: it cannot grow past it. Pages of evicted
 *             objects are used again; incremental vacuum returns them to the disk only when the
 *             budget was made smaller.
 *
 * Exclusive locking keeps the log's index in memory, so there is no third file. */

enum { BATCH_BYTES_MAX = 2 << 20 };

int64_t cache_tick(const struct cache *cache)
{
	return cache->first_tick + (clock_now_ms() - cache->opened_ms) / 1000;
}

/* ---- transactions */

/* What failed to be written must not remain partly in the next transaction. */
static void roll_back(struct cache *cache)
{
	if (!cache->db || !cache->in_batch)
		return;
	/* It fails if SQLite has rolled back already; that is fine. */
	sqlite3_exec(cache->db, "ROLLBACK", NULL, NULL, NULL);
	cache->in_batch = false;
	cache->batch_pages = 0;
}

static int checkpoint(struct cache *cache)
{
	int left = 0, done = 0;
	int code;

	if ((uint64_t)cache->log_pages * CACHE_PAGE_BYTES < cache->log_bytes / 2)
		return 0;
	code = sqlite3_wal_checkpoint_v2(cache->db, NULL, SQLITE_CHECKPOINT_RESTART, &left, &done);
	if (code == SQLITE_OK && left == done)
		cache->log_pages = 0;
	return cache_judge(cache, db_code(code), "writing the log back");
}

int cache_begin(struct cache *cache)
{
	int rc;

	if (cache->in_batch)
		return 0;
	rc = checkpoint(cache);
	if (rc < 0)
		return rc;
	rc = cache_judge(cache, db_run(cache->statements[STATEMENT_BEGIN]), "beginning to write");
	cache->in_batch = rc == 0;
	cache->batch_pages = 0;
	return rc;
}

int cache_flush(struct cache *cache)
{
	const uint64_t set_aside = cache->figures.set_aside;
	sqlite3_stmt *tick;
	int rc;

	if (!cache->db || !cache->in_batch)
		return 0;
	tick = cache->statements[STATEMENT_TICK];
	sqlite3_bind_int64(tick, 1, cache_tick(cache));
	rc = cache_judge(cache, db_run(tick), "writing");
	if (rc == 0 && cache->in_batch)
		rc = cache_judge(cache, db_run(cache->statements[STATEMENT_COMMIT]), "writing");
	if (rc < 0) {
		cache->figures.refused_writes++;
		cache->has_lost = true;
		roll_back(cache);
		return rc;
	}
	cache->in_batch = false;
	cache->batch_pages = 0;
	/* The commit succeeded. If the log cannot be written back now, cache_begin notices it
	 * again; but if that showed damage, a new cache has begun, and with it new statements. */
	rc = checkpoint(cache);
	return cache->figures.set_aside > set_aside ? rc : 0;
}

int cache_sync(struct cache *cache)
{
	int rc = cache_flush(cache), code;

	if (rc < 0 || !cache->db)
		return rc < 0 ? rc : -EIO;
	/* A commit alone does not sync; writing the log back does, before and after. */
	code = sqlite3_wal_checkpoint_v2(cache->db, NULL, SQLITE_CHECKPOINT_FULL, NULL, NULL);
	rc = cache_judge(cache, db_code(code), "writing the log back");
	if (rc < 0 || !cache->has_lost)
		return rc;
	cache->has_lost = false;
	return -EIO;
}

bool cache_needs_flush(const struct cache *cache)
{
	return cache->in_batch;
}

static bool is_too_long(const struct cache *cache, int64_t pages)
{
	uint64_t most = cache->log_bytes / 4;

	if (most > BATCH_BYTES_MAX)
		most = BATCH_BYTES_MAX;
	return (cache->batch_pages + (uint64_t)pages) * CACHE_PAGE_BYTES >= most;
}

int cache_reserve_pages(struct cache *cache, int64_t pages)
{
	return is_too_long(cache, pages) ? cache_flush(cache) : 0;
}

int cache_count_pages(struct cache *cache, int64_t pages)
{
	cache->batch_pages += (uint64_t)pages;
	return is_too_long(cache, 0) ? cache_flush(cache) : 0;
}

/* ---- eviction */

/* Drops the least useful object. Returns -EDQUOT if everything that is left is kept. */
static int evict_one(struct cache *cache)
{
	sqlite3_stmt *least = cache->statements[STATEMENT_MIN];
	sqlite3_stmt *drop = cache->statements[STATEMENT_DROP];
	int code = sqlite3_step(least);
	sqlite3_int64 id = code == SQLITE_ROW ? sqlite3_column_int64(least, 0) : 0;
	int rc = db_code(code);

	sqlite3_reset(least);
	if (rc == 0 && code == SQLITE_DONE)
		return -EDQUOT;
	if (rc == 0) {
		sqlite3_bind_int64(drop, 1, id);
		rc = db_run(drop);
	}
	rc = cache_judge(cache, rc, "making room");
	if (rc == 0) {
		cache->figures.evicted++;
		cache->batch_pages += CACHE_EXTRA_PAGES;
	}
	return rc;
}

int64_t cache_free_pages(struct cache *cache)
{
	int64_t most = (int64_t)((cache->budget_bytes - cache->log_bytes) / CACHE_PAGE_BYTES);

	return most - cache_integer(cache, STATEMENT_PAGES) +
	       cache_integer(cache, STATEMENT_FREE_PAGES);
}

/* A transaction that grows too long is ended in between. */
int cache_make_room(struct cache *cache, int64_t wanted)
{
	int rc = cache_begin(cache);

	while (rc == 0 && cache_free_pages(cache) < wanted) {
		rc = evict_one(cache);
		if (rc == 0)
			rc = cache_count_pages(cache, 0);
		if (rc == 0)
			rc = cache_begin(cache);
	}
	return rc;
}

/* If the budget was made smaller, more may be kept than it can hold. Then nothing stays kept. */
static int make_room_at_any_price(struct cache *cache)
{
	int rc = cache_make_room(cache, CACHE_EXTRA_PAGES);

	if (rc != -EDQUOT || !cache->db)
		return rc;
	rc = cache_judge(cache, db_exec(cache->db, "UPDATE objects SET kept = 0 WHERE kept = 1"),
			 "keeping less");
	return rc < 0 ? rc : cache_make_room(cache, CACHE_EXTRA_PAGES);
}

void cache_shrink(struct cache *cache)
{
	int64_t most = (int64_t)((cache->budget_bytes - cache->log_bytes) / CACHE_PAGE_BYTES);
	char sql[64];

	if (cache_integer(cache, STATEMENT_PAGES) <= most)
		return;
	if (make_room_at_any_price(cache) < 0 || cache_flush(cache) < 0 || !cache->db)
		return;
	/* In steps, because moving pages goes through the log. */
	snprintf(sql, sizeof(sql), "PRAGMA incremental_vacuum(%lld)",
		 (long long)(cache->log_bytes / CACHE_PAGE_BYTES / 8));
	for (int64_t pages = cache_integer(cache, STATEMENT_PAGES), before = pages + 1;
	     pages > most && pages < before; pages = cache_integer(cache, STATEMENT_PAGES)) {
		before = pages;
		if (cache_judge(cache, db_exec(cache->db, sql), "shrinking the cache") < 0 ||
		    checkpoint(cache) < 0 || !cache->db)
			return;
	}
	sqlite3_wal_checkpoint_v2(cache->db, NULL, SQLITE_CHECKPOINT_TRUNCATE, NULL, NULL);
	cache->log_pages = 0;
	/* max_page_count could not be set below the old size. */
	if (cache_judge(cache, cache_set_pragmas(cache), "shrinking the cache") < 0)
		cache->figures.refused_writes++;
}
