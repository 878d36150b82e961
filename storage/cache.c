/* The calls of the object cache: get, put, keep and the choice of releases. Every object's hash is
 * checked when it is read. */
#include "storage/cache.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>

#include "base/log.h"
#include "storage/cache_file.h"
#include "storage/cache_private.h"
#include "storage/cache_room.h"

enum {
	LOG_BYTES_MAX = 64 << 20,
	DISK_PERCENT = 60, /* of the file system, at most */
	TOUCH_S = 600, /* minimum time between two rank updates of an object: each costs a write */
	EVICT_TRIES = 8,
	KEPT_NOW = 1, /* bits of keeps.releases */
	KEPT_BEFORE = 2,
};

static int64_t pages_of(size_t bytes)
{
	return (int64_t)(bytes / (CACHE_PAGE_BYTES - 4)) + 1;
}

/* Converts a priority to seconds of use. */
static int64_t worth_s(uint32_t priority)
{
	int64_t hours = 0;

	if (priority >= 1000000)
		return 7 * 24 * 3600;
	for (uint32_t gain = priority / 1000; gain > 0; gain /= 2)
		hours++;
	return hours * 3600;
}

static sqlite3_stmt *bound_to_hash(struct cache *cache, enum statement which,
				   const struct hash *hash)
{
	sqlite3_stmt *statement = cache->statements[which];

	sqlite3_reset(statement);
	sqlite3_bind_blob(statement, 1, hash->bytes, HASH_BYTES, SQLITE_STATIC);
	return statement;
}

uint64_t cache_budget_in(const char *folder, uint64_t budget_bytes)
{
	struct statvfs disk;
	uint64_t most;

	if (statvfs(folder, &disk) == 0) {
		/* The state, the journal and others are on the file system too. */
		most = (uint64_t)disk.f_blocks * disk.f_frsize / 100 * DISK_PERCENT;
		if (budget_bytes > most)
			budget_bytes = most;
	}
	return budget_bytes < CACHE_BUDGET_MIN ? CACHE_BUDGET_MIN : budget_bytes;
}

static uint64_t budget_of(const struct cache_options *options)
{
	const char *slash = strrchr(options->path, '/');
	char folder[PATH_MAX] = ".";

	if (slash)
		snprintf(folder, sizeof(folder), "%.*s", (int)(slash - options->path + 1),
			 options->path);
	return cache_budget_in(folder, options->budget_bytes);
}

int cache_create(struct cache **out, const struct cache_options *options)
{
	struct cache *cache = calloc(1, sizeof(*cache));

	*out = NULL;
	if (!cache)
		return -ENOMEM;
	cache->path = strdup(options->path);
	if (!cache->path) {
		free(cache);
		return -ENOMEM;
	}
	cache->budget_bytes = budget_of(options);
	cache->log_bytes = cache->budget_bytes / 8;
	if (cache->log_bytes > LOG_BYTES_MAX)
		cache->log_bytes = LOG_BYTES_MAX;
	if (cache_ready(cache))
		cache_shrink(cache);
	cache->has_lost = false;
	*out = cache;
	return 0;
}

void cache_destroy(struct cache *cache)
{
	if (!cache)
		return;
	if (cache_flush(cache) < 0)
		log_warn("storage", "%s: the last objects could not be written", cache->path);
	cache_close(cache);
	free(cache->path);
	free(cache);
}

/* Copies the blob of a column into out. */
static int take_blob(struct buffer *out, sqlite3_stmt *statement, int column)
{
	const void *bytes = sqlite3_column_blob(statement, column);
	int size = sqlite3_column_bytes(statement, column);

	if (size > 0 && !bytes)
		return db_code(sqlite3_errcode(sqlite3_db_handle(statement)));
	buffer_put(out, bytes, (size_t)size);
	return 0;
}

/* The object was requested again: raises its rank, so that it is evicted later. A failure has no
 * other effect. */
static void touch(struct cache *cache, sqlite3_int64 id, sqlite3_int64 rank, uint32_t priority)
{
	sqlite3_stmt *statement = cache->statements[STATEMENT_TOUCH];
	int64_t now = cache_tick(cache) + worth_s(priority);

	if (now < rank + TOUCH_S || cache_begin(cache) < 0)
		return;
	sqlite3_bind_int64(statement, 1, id);
	sqlite3_bind_int64(statement, 2, now);
	if (cache_judge(cache, db_run(statement), "noting a want") < 0 ||
	    cache_count_pages(cache, CACHE_EXTRA_PAGES) < 0)
		return; /* logged already */
}

static int drop_damaged(struct cache *cache, sqlite3_int64 id)
{
	sqlite3_stmt *drop;

	cache->figures.damaged++;
	if (cache_begin(cache) < 0)
		return -EBADMSG;
	drop = cache->statements[STATEMENT_DROP];
	sqlite3_bind_int64(drop, 1, id);
	if (cache_judge(cache, db_run(drop), "dropping") == 0)
		cache->batch_pages += CACHE_EXTRA_PAGES;
	return -EBADMSG;
}

int cache_get(struct cache *cache, struct hash hash, uint32_t priority, struct buffer *out)
{
	sqlite3_int64 id = 0, rank = 0;
	sqlite3_stmt *get;
	int code, rc;

	buffer_clear(out);
	if (!cache_ready(cache))
		return -ENOENT;
	get = bound_to_hash(cache, STATEMENT_GET, &hash);
	code = sqlite3_step(get);
	rc = db_code(code);
	if (code == SQLITE_ROW) {
		id = sqlite3_column_int64(get, 0);
		rank = sqlite3_column_int64(get, 1);
		rc = take_blob(out, get, 2);
	}
	sqlite3_reset(get);
	rc = cache_judge(cache, rc, "reading");
	if (rc < 0 || code == SQLITE_DONE) {
		cache->figures.misses++;
		return rc < 0 ? rc : -ENOENT;
	}
	if (out->error)
		return out->error;
	if (!hash_equal(hash_of(buffer_bytes(out)), hash))
		return drop_damaged(cache, id);
	cache->figures.hits++;
	touch(cache, id, rank, priority);
	return 0;
}

/* Returns for which releases the object is kept: KEPT_NOW, KEPT_BEFORE, both or none. */
static int kept_for(struct cache *cache, const struct hash *hash)
{
	sqlite3_stmt *statement = bound_to_hash(cache, STATEMENT_IS_KEPT, hash);
	int releases = sqlite3_step(statement) == SQLITE_ROW ? sqlite3_column_int(statement, 0) : 0;

	sqlite3_reset(statement);
	return releases;
}

static bool may_keep_more(struct cache *cache)
{
	int64_t kept = cache_integer(cache, STATEMENT_KEPT_BYTES);

	return kept >= 0 && (uint64_t)kept < cache->budget_bytes / 4 * 3;
}

/* SQLite may still find no room, for instance if a free list is damaged or the disk is full.
 * Evicting more is worth a few tries. */
static int put_with_room(struct cache *cache, sqlite3_stmt *put, int64_t pages)
{
	int rc = cache_make_room(cache, pages);

	for (int i = 0; rc == 0; i++) {
		rc = db_run(put);
		if (rc != -ENOSPC || i == EVICT_TRIES || sqlite3_get_autocommit(cache->db))
			return cache_judge(cache, rc, "writing");
		rc = cache_make_room(cache, cache_free_pages(cache) + pages);
	}
	return rc;
}

static bool ready_to_store(struct cache *cache)
{
	const bool ready = cache_ready(cache);

	if (!ready) {
		cache->figures.refused_writes++;
		cache->has_lost = true;
	}
	return ready;
}

static int put_row(struct cache *cache, sqlite3_stmt *put, size_t bytes)
{
	int64_t pages = pages_of(bytes) + CACHE_EXTRA_PAGES;
	int rc;

	if ((uint64_t)pages * CACHE_PAGE_BYTES > cache->log_bytes / 4 + 8 * CACHE_PAGE_BYTES)
		return -EFBIG;
	/* Flush first, so that a large row gets its own transaction; otherwise the log could exceed
	 * its share. */
	rc = cache_reserve_pages(cache, pages);
	if (rc == 0)
		rc = put_with_room(cache, put, pages);
	if (rc == -EDQUOT) /* the budget is to blame, not the disk */
		return -ENOSPC;
	if (rc < 0) {
		cache->figures.refused_writes++;
		cache->has_lost = true;
		return rc;
	}
	return cache_count_pages(cache, pages);
}

int cache_put(struct cache *cache, struct hash hash, struct bytes object, uint32_t priority)
{
	sqlite3_stmt *put;
	bool kept;
	int rc;

	if (!ready_to_store(cache))
		return -EIO;
	kept = kept_for(cache, &hash) != 0 && may_keep_more(cache);
	put = bound_to_hash(cache, STATEMENT_PUT, &hash);
	sqlite3_bind_int64(put, 2, cache_tick(cache) + worth_s(priority));
	sqlite3_bind_int(put, 3, kept);
	sqlite3_bind_int64(put, 4, (sqlite3_int64)object.size);
	sqlite3_bind_blob64(put, 5, object.data ? (const void *)object.data : "", object.size,
			    SQLITE_STATIC);
	rc = put_row(cache, put, object.size);
	if (cache->db)
		sqlite3_clear_bindings(cache->statements[STATEMENT_PUT]);
	return rc;
}

int cache_keep(struct cache *cache, struct hash hash)
{
	int rc;

	if (!cache_ready(cache))
		return -EIO;
	if (kept_for(cache, &hash) & KEPT_NOW)
		return 0;
	if (!may_keep_more(cache))
		return -ENOSPC;
	rc = cache_begin(cache);
	if (rc == 0)
		rc = cache_judge(cache, db_run(bound_to_hash(cache, STATEMENT_KEEP, &hash)),
				 "keeping");
	if (rc == 0)
		rc = cache_judge(cache, db_run(bound_to_hash(cache, STATEMENT_MARK_KEPT, &hash)),
				 "keeping");
	return rc < 0 ? rc : cache_count_pages(cache, CACHE_EXTRA_PAGES);
}

static bool is_fact(struct cache *cache, const char *name, const char *value)
{
	sqlite3_int64 count;
	char sql[128];

	snprintf(sql, sizeof(sql), "SELECT count(*) FROM facts WHERE name = '%s' AND value = '%s'",
		 name, value);
	return db_integer(cache->db, sql, &count) == 0 && count == 1;
}

int cache_use_release(struct cache *cache, struct hash root)
{
	char hex[HASH_HEX_BYTES], sql[1024];
	bool returns;
	int rc;

	if (!cache_ready(cache))
		return -EIO;
	hash_to_hex(root, hex);
	if (is_fact(cache, "release", hex))
		return 0;
	returns = is_fact(cache, "before", hex);
	rc = cache_begin(cache);
	if (rc < 0)
		return rc;
	/* The release in use becomes the one before. The one before is in use again, or no longer
	 * kept. */
	snprintf(
		sql, sizeof(sql),
		"UPDATE keeps SET releases = (releases & %d) * 2 + (releases & %d) / 2;"
		"DELETE FROM keeps WHERE releases = 0;"
		"UPDATE objects SET kept = 0 WHERE kept = 1 AND hash NOT IN (SELECT hash FROM keeps);"
		"INSERT OR REPLACE INTO facts (name, value)"
		" SELECT 'before', value FROM facts WHERE name = 'release';"
		"INSERT OR REPLACE INTO facts (name, value) VALUES ('release', '%s');"
		"DELETE FROM files WHERE lower(hex(name)) NOT IN"
		" (SELECT value FROM facts WHERE name IN ('release', 'before'))",
		KEPT_NOW, returns ? KEPT_BEFORE : 0, hex);
	rc = cache_judge(cache, db_exec(cache->db, sql), "changing the release");
	return rc < 0 ? rc : cache_flush(cache);
}

int cache_get_file(struct cache *cache, struct hash name, struct buffer *out)
{
	struct hash check = { { 0 } };
	sqlite3_stmt *get;
	int code, rc;

	buffer_clear(out);
	if (!cache_ready(cache))
		return -ENOENT;
	get = bound_to_hash(cache, STATEMENT_GET_FILE, &name);
	code = sqlite3_step(get);
	rc = db_code(code);
	if (code == SQLITE_ROW && sqlite3_column_bytes(get, 0) == HASH_BYTES)
		memcpy(check.bytes, sqlite3_column_blob(get, 0), HASH_BYTES);
	if (code == SQLITE_ROW)
		rc = take_blob(out, get, 1);
	sqlite3_reset(get);
	rc = cache_judge(cache, rc, "reading a file");
	if (rc < 0 || code == SQLITE_DONE)
		return rc < 0 ? rc : -ENOENT;
	if (out->error)
		return out->error;
	return hash_equal(hash_of(buffer_bytes(out)), check) ? 0 : -EBADMSG;
}

int cache_put_file(struct cache *cache, struct hash name, struct bytes file)
{
	struct hash check = hash_of(file);
	sqlite3_stmt *put;
	int rc;

	if (!ready_to_store(cache))
		return -EIO;
	put = bound_to_hash(cache, STATEMENT_PUT_FILE, &name);
	sqlite3_bind_blob(put, 2, check.bytes, HASH_BYTES, SQLITE_STATIC);
	sqlite3_bind_blob64(put, 3, file.data ? (const void *)file.data : "", file.size,
			    SQLITE_STATIC);
	rc = put_row(cache, put, file.size);
	if (cache->db)
		sqlite3_clear_bindings(cache->statements[STATEMENT_PUT_FILE]);
	return rc < 0 ? rc : cache_flush(cache);
}

static uint64_t size_of_file(const char *path, const char *suffix)
{
	char name[4096];
	struct stat info;

	snprintf(name, sizeof(name), "%s%s", path, suffix);
	return stat(name, &info) == 0 ? (uint64_t)info.st_size : 0;
}

uint64_t cache_file_bytes(const struct cache *cache)
{
	return size_of_file(cache->path, "") + size_of_file(cache->path, "-wal");
}

uint64_t cache_budget_bytes(const struct cache *cache)
{
	return cache->budget_bytes;
}

uint64_t cache_refused_writes(const struct cache *cache)
{
	return cache->figures.refused_writes;
}

void cache_figures(struct cache *cache, struct cache_figures *out)
{
	sqlite3_int64 objects, bytes;
	int64_t kept;

	*out = cache->figures;
	out->budget_bytes = cache->budget_bytes;
	out->file_bytes = cache_file_bytes(cache);
	if (!cache->db)
		return;
	kept = cache_integer(cache, STATEMENT_KEPT_BYTES);
	out->kept_bytes = kept > 0 ? (uint64_t)kept : 0;
	if (db_integer(cache->db, "SELECT count(*) FROM objects", &objects) == 0)
		out->objects = (uint64_t)objects;
	if (db_integer(cache->db, "SELECT ifnull(sum(size), 0) FROM objects", &bytes) == 0)
		out->object_bytes = (uint64_t)bytes;
}
