/* Opens the cache's database, prepares its statements, and replaces a damaged file with a new
 * one. */
#include "storage/cache_file.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/log.h"

enum {
	RETRY_MS = 30000,
	COMPLAIN_MS = 60000,
	FAULTS_MAX = 16, /* failed reads in a row after which the file counts as damaged */
	BROKEN_BYTES_MAX =
		1 << 20, /* how much of a damaged file is kept for inspection: header and schema */
	SCHEMA_VERSION = 2,
};

static const char *const statement_sql[STATEMENT_COUNT] = {
	[STATEMENT_BEGIN] = "BEGIN IMMEDIATE",
	[STATEMENT_COMMIT] = "COMMIT",
	[STATEMENT_GET] = "SELECT id, rank, bytes FROM objects WHERE hash = ?1",
	[STATEMENT_TOUCH] = "UPDATE objects SET rank = ?2 WHERE id = ?1",
	[STATEMENT_PUT] = "INSERT OR REPLACE INTO objects (hash, rank, kept, size, bytes)"
			  " VALUES (?1, ?2, ?3, ?4, ?5)",
	[STATEMENT_DROP] = "DELETE FROM objects WHERE id = ?1",
	[STATEMENT_MIN] = "SELECT id, size FROM objects WHERE kept = 0 ORDER BY rank, size LIMIT 1",
	[STATEMENT_IS_KEPT] = "SELECT releases FROM keeps WHERE hash = ?1",
	[STATEMENT_KEEP] = "INSERT INTO keeps (hash, releases) VALUES (?1, 1)"
			   " ON CONFLICT (hash) DO UPDATE SET releases = releases | 1",
	[STATEMENT_MARK_KEPT] = "UPDATE objects SET kept = 1 WHERE hash = ?1 AND kept = 0",
	[STATEMENT_KEPT_BYTES] = "SELECT ifnull(sum(size), 0) FROM objects WHERE kept = 1",
	[STATEMENT_GET_FILE] = "SELECT check_hash, bytes FROM files WHERE name = ?1",
	[STATEMENT_PUT_FILE] = "INSERT OR REPLACE INTO files (name, check_hash, bytes)"
			       " VALUES (?1, ?2, ?3)",
	[STATEMENT_FREE_PAGES] = "PRAGMA freelist_count",
	[STATEMENT_PAGES] = "PRAGMA page_count",
	[STATEMENT_TICK] = "INSERT OR REPLACE INTO facts (name, value) VALUES ('tick', ?1)",
};

/* keeps.releases: bit 0 for the release in use, bit 1 for the one before. facts.release and
 * facts.before hold their names. Objects need a rowid: reading large rows by a WITHOUT ROWID key is
 * seven times slower. */
static const char schema[] =
	"CREATE TABLE objects (id INTEGER PRIMARY KEY, hash BLOB NOT NULL, rank INTEGER NOT NULL,"
	" kept INTEGER NOT NULL, size INTEGER NOT NULL, bytes BLOB NOT NULL);"
	"CREATE UNIQUE INDEX objects_hash ON objects (hash);"
	"CREATE INDEX objects_rank ON objects (rank, size) WHERE kept = 0;"
	"CREATE INDEX objects_kept ON objects (size) WHERE kept = 1;"
	"CREATE TABLE keeps (hash BLOB PRIMARY KEY, releases INTEGER NOT NULL) WITHOUT ROWID;"
	"CREATE TABLE files (id INTEGER PRIMARY KEY, name BLOB NOT NULL UNIQUE,"
	" check_hash BLOB NOT NULL, bytes BLOB NOT NULL);"
	"CREATE TABLE facts (name TEXT PRIMARY KEY, value) WITHOUT ROWID;";

/* Logs at most once a minute: a full disk would cause the same message a thousand times. */
static void complain(struct cache *cache, int rc, const char *doing)
{
	int64_t now_ms = clock_now_ms();

	if (now_ms < cache->complain_at_ms)
		return;
	cache->complain_at_ms = now_ms + COMPLAIN_MS;
	log_warn("storage", "%s: %s: %s; going on without", cache->path, doing,
		 cache->db ? sqlite3_errmsg(cache->db) : strerror(-rc));
}

void cache_close(struct cache *cache)
{
	for (size_t i = 0; i < STATEMENT_COUNT; i++) {
		sqlite3_finalize(cache->statements[i]);
		cache->statements[i] = NULL;
	}
	sqlite3_close_v2(cache->db);
	cache->db = NULL;
	cache->in_batch = false;
	cache->batch_pages = 0;
	cache->log_pages = 0;
}

/* Counts a failed read. Returns -EBADMSG if there were too many in a row, else -EIO: a new cache
 * begins empty, perhaps far from any server. */
static int count_fault(struct cache *cache)
{
	return ++cache->faults < FAULTS_MAX ? -EIO : -EBADMSG;
}

static int on_log(void *data, sqlite3 *db, const char *name, int pages)
{
	struct cache *cache = data;

	(void)db;
	(void)name;
	cache->log_pages = pages;
	return SQLITE_OK;
}

/* Creates the schema in an empty file. A file of another kind or version is treated as damaged:
 * nothing in it is needed. A file that cannot be read just now is not. */
static int check_schema(struct cache *cache)
{
	sqlite3_int64 version, tables;
	char sql[64];
	int rc = db_integer(cache->db, "PRAGMA user_version", &version);

	if (rc == 0 && version == SCHEMA_VERSION)
		return 0;
	if (rc == 0)
		rc = db_integer(cache->db, "SELECT count(*) FROM sqlite_schema", &tables);
	if (rc == 0 && (version < 0 || tables != 0))
		rc = -EBADMSG;
	if (rc < 0)
		return rc;
	rc = db_exec(cache->db, "BEGIN IMMEDIATE");
	if (rc == 0)
		rc = db_exec(cache->db, schema);
	snprintf(sql, sizeof(sql), "PRAGMA user_version=%d; COMMIT", SCHEMA_VERSION);
	return rc < 0 ? rc : db_exec(cache->db, sql);
}

int cache_set_pragmas(struct cache *cache)
{
	char sql[128];
	int rc = db_exec(cache->db, "PRAGMA page_size=4096; PRAGMA auto_vacuum=INCREMENTAL;"
				    "PRAGMA journal_mode=WAL; PRAGMA synchronous=NORMAL;"
				    "PRAGMA cache_spill=OFF; PRAGMA cache_size=-2000;"
				    "PRAGMA temp_store=MEMORY");

	if (rc < 0)
		return rc;
	sqlite3_wal_autocheckpoint(cache->db, 0); /* checkpoint() does this and sees failures */
	sqlite3_wal_hook(cache->db, on_log, cache);
	snprintf(sql, sizeof(sql), "PRAGMA max_page_count=%lld; PRAGMA journal_size_limit=%lld",
		 (long long)((cache->budget_bytes - cache->log_bytes) / CACHE_PAGE_BYTES),
		 (long long)cache->log_bytes);
	return db_exec(cache->db, sql);
}

static int prepare_all(struct cache *cache)
{
	for (size_t i = 0; i < STATEMENT_COUNT; i++) {
		int code =
			sqlite3_prepare_v3(cache->db, statement_sql[i], -1,
					   SQLITE_PREPARE_PERSISTENT, &cache->statements[i], NULL);

		if (code == SQLITE_ERROR) /* no such table or column */
			return -EBADMSG;
		if (code != SQLITE_OK)
			return db_code(code);
	}
	return 0;
}

/* -EBADMSG: damaged, a new one must take its place. */
static int open_db(struct cache *cache)
{
	int rc = db_open(&cache->db, cache->path);
	sqlite3_int64 tick = 0;

	if (rc == 0)
		rc = cache_set_pragmas(cache);
	if (rc == 0)
		rc = check_schema(cache);
	if (rc == 0)
		rc = prepare_all(cache);
	if (rc == 0) {
		rc = db_integer(cache->db, "SELECT value FROM facts WHERE name = 'tick'", &tick);
		rc = rc == -ENOENT ? 0 : rc;
	}
	/* Read-only although the file is writable: its header claims a format of the future. */
	if (rc == -EROFS && access(cache->path, W_OK) == 0)
		rc = -EBADMSG;
	if (rc < 0) {
		complain(cache, rc, "opening the cache");
		if (rc == -EBADMSG && db_read_failed(cache->db))
			rc = count_fault(cache);
		cache_close(cache);
		return rc;
	}
	cache->first_tick = tick > 0 ? tick : 0;
	cache->opened_ms = clock_now_ms();
	sqlite3_wal_checkpoint_v2(cache->db, NULL, SQLITE_CHECKPOINT_TRUNCATE, NULL, NULL);
	return 0;
}

/* Sets a damaged database aside and starts a new one. */
static void start_over(struct cache *cache)
{
	int rc;

	cache_close(cache);
	cache->faults = 0;
	cache->has_lost = true;
	cache->figures.set_aside++;
	rc = db_set_aside(cache->path, BROKEN_BYTES_MAX);
	log_warn("storage", "%s was damaged; renamed to %s.broken, and a new cache begins",
		 cache->path, cache->path);
	if (rc == 0)
		rc = open_db(cache);
	if (rc < 0) {
		complain(cache, rc, "beginning a new cache");
		cache->retry_at_ms = clock_now_ms() + RETRY_MS;
	}
}

/* Handles every result of SQLite. After a failure the transaction may be gone. */
int cache_judge(struct cache *cache, int rc, const char *doing)
{
	if (rc == 0) {
		cache->faults = 0;
		return 0;
	}
	complain(cache, rc, doing);
	if (cache->in_batch && sqlite3_get_autocommit(cache->db)) {
		cache->has_lost = true;
		cache->in_batch = false;
		cache->batch_pages = 0;
	}
	if (rc == -EIO || (rc == -EBADMSG && db_read_failed(cache->db)))
		rc = count_fault(cache);
	if (rc == -EBADMSG)
		start_over(cache);
	return rc == -EROFS || rc == -EBUSY || rc == -EBADMSG ? -EIO : rc;
}

bool cache_ready(struct cache *cache)
{
	if (cache->db)
		return true;
	if (clock_now_ms() < cache->retry_at_ms)
		return false;
	cache->retry_at_ms = clock_now_ms() + RETRY_MS;
	if (open_db(cache) == -EBADMSG)
		start_over(cache);
	return cache->db != NULL;
}

int64_t cache_integer(struct cache *cache, enum statement which)
{
	sqlite3_stmt *statement = cache->statements[which];
	int64_t value =
		sqlite3_step(statement) == SQLITE_ROW ? sqlite3_column_int64(statement, 0) : -1;

	sqlite3_reset(statement);
	return value;
}
