/* The object cache on disk, in SQLite, within a budget of bytes. docs/cache.md explains how the
 * budget is kept.
 *
 * Past the budget, the least useful object is evicted first. A request counts as if it had come
 * later, by an amount that depends on its priority (an index page a week, a tile up to ten hours).
 * Time is counted in seconds of use, so a wrong wall clock has no effect. What is kept (cache_keep)
 * is never evicted.
 *
 * A damaged database is renamed to PATH.broken and a new one is started. If the disk is full or
 * fails, writes are refused and the cache goes on. So no error of this module is a reason to stop.
 *
 * Writes are collected in a transaction. cache_flush ends it; so do enough writes. One thread; only
 * this process may have the file open. A call may wait for the disk. */
#ifndef GOPURA_STORAGE_CACHE_H
#define GOPURA_STORAGE_CACHE_H

#include "format/hash.h"

struct cache; /* private to cache*.c */

enum { CACHE_BUDGET_MIN = 4 << 20 /* bytes; a smaller budget is raised to this */ };

struct cache_options {
	const char *path;      /* copied; its folder must exist */
	uint64_t budget_bytes; /* for PATH and PATH-wal together */
};

struct cache_figures {
	uint64_t budget_bytes;
	uint64_t file_bytes; /* current size of PATH and PATH-wal */
	uint64_t objects, object_bytes, kept_bytes;
	uint64_t hits, misses, evicted, damaged, refused_writes, set_aside; /* since cache_create */
};

/* *out is owned by the caller. It fails only with -ENOMEM. If the file cannot be opened, the cache
 * is empty, accepts nothing, and tries again every half minute. */
must_check int cache_create(struct cache **out, const struct cache_options *options);
void cache_destroy(struct cache *cache); /* flushes; NULL is fine */

/* Reads an object into *out, which is cleared first; its hash is checked.
 *   -ENOENT   ask the network        -EBADMSG  it was damaged and is now dropped: ask the network
 *   -EIO      the disk failed        -EFBIG    past out's ceiling        -ENOMEM
 * priority is as in format/message.h. */
must_check int cache_get(struct cache *cache, struct hash hash, uint32_t priority,
			 struct buffer *out);
/* Stores an object. The caller has checked its hash. Storing it again is fine.
 *   -ENOSPC  disk full, or all that could be evicted is kept     -EFBIG  no object that large fits
 *   -EIO     the disk failed */
must_check int cache_put(struct cache *cache, struct hash hash, struct bytes object,
			 uint32_t priority);
/* Protects an object from eviction while the release in use (cache_use_release) or the one before
 * is that release. It may be called before the object arrives. Returns -ENOSPC if three quarters of
 * the budget are kept already, or -EIO. */
must_check int cache_keep(struct cache *cache, struct hash hash);
/* Sets the release in use. What was kept for the last release stays kept, so that one can return to
 * it. What was kept for the release before that is no longer kept, and other files are dropped. If
 * the release is the same, nothing changes, even after a restart. Returns -EIO or the errors of
 * cache_flush. */
must_check int cache_use_release(struct cache *cache, struct hash root);

/* A whole file that is stored beside the objects for as long as its release is kept: the locator of
 * a release, under its root hash. Errors as cache_get and cache_put. */
must_check int cache_get_file(struct cache *cache, struct hash name, struct buffer *out);
/* Also flushes. */
must_check int cache_put_file(struct cache *cache, struct hash name, struct bytes file);

/* Commits the collected writes. On failure, what was put since the last commit is lost from the
 * cache. */
must_check int cache_flush(struct cache *cache);
/* As cache_flush, and waits for the disk, so that the contents of the cache survive a power cut.
 * Returns -EIO, once, if the disk refused something since the last call that succeeded or said so:
 * what was put then may be missing. What can never fit, or for lack of room beside what is kept,
 * does not count. */
must_check int cache_sync(struct cache *cache);
/* Returns true if writes are waiting for a commit. */
bool cache_needs_flush(const struct cache *cache);

/* Returns the budget that a cache in a folder keeps to: at most 60 % of the file system. */
uint64_t cache_budget_in(const char *folder, uint64_t budget_bytes);
uint64_t cache_budget_bytes(const struct cache *cache); /* the one that is kept */
/* How often the disk did not take what was to be stored, since cache_create; also where the file
 * cannot even be opened. */
uint64_t cache_refused_writes(const struct cache *cache);
uint64_t cache_file_bytes(const struct cache *cache); /* current size of PATH and PATH-wal */
/* Sets all figures. It counts rows, so do not call it every second. */
void cache_figures(struct cache *cache, struct cache_figures *out);

#endif
