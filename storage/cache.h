/* Objects on disk, in SQLite, within a budget of bytes. docs/cache.md tells how the budget holds.
 *
 * Past the budget the least useful object goes first: a want counts as if it had come later by
 * what its priority is worth (an index page a week, a tile up to ten hours). Time is counted in
 * seconds of use, so a wrong wall clock changes nothing. What is kept (cache_keep) never goes.
 *
 * A damaged database is set aside as PATH.broken and a fresh one begun; a full disk or one that
 * fails refuses writes and the cache goes on. So no error of this module is a reason to stop.
 *
 * Writes gather in a transaction: cache_flush ends it, as does enough of them. One thread; this
 * process alone may have the file open. A call may wait for the disk. */
#ifndef GOPURA_STORAGE_CACHE_H
#define GOPURA_STORAGE_CACHE_H

#include "format/hash.h"

struct cache; /* private to cache.c */

enum { CACHE_BUDGET_MIN = 4 << 20 /* bytes; a smaller budget is raised to this */ };

struct cache_options {
	const char *path;      /* copied; its folder must exist */
	uint64_t budget_bytes; /* of PATH and PATH-wal together */
};

struct cache_figures {
	uint64_t budget_bytes;
	uint64_t file_bytes; /* of PATH and PATH-wal now */
	uint64_t objects, object_bytes, kept_bytes;
	uint64_t hits, misses, evicted, damaged, refused_writes, set_aside; /* since create */
};

/* *out is owned by the caller. Fails with -ENOMEM alone: where the file cannot be opened, the
 * cache is empty, takes nothing, and tries again every half minute. */
must_check int cache_create(struct cache **out, const struct cache_options *options);
void cache_destroy(struct cache *cache); /* flushes; NULL is fine */

/* *out (cleared first) gets the object's bytes, hashed and found right.
 *   -ENOENT   ask the network        -EBADMSG  it was damaged and is now dropped: ask the network
 *   -EIO      the disk failed        -EFBIG    past out's ceiling        -ENOMEM
 * priority as in format/message.h. */
must_check int cache_get(struct cache *cache, struct hash hash, uint32_t priority,
			 struct buffer *out);
/* The caller has checked that hash is the object's. Putting it again is fine.
 *   -ENOSPC  disk full, or all that could go is kept     -EFBIG  no object that large fits
 *   -EIO     the disk failed */
must_check int cache_put(struct cache *cache, struct hash hash, struct bytes object,
			 uint32_t priority);
/* Must not go while release (cache_use_release) is in use, nor while it is the one before; may be
 * said before the object came. -ENOSPC: three quarters of the budget are kept already. -EIO. */
must_check int cache_keep(struct cache *cache, struct hash hash);
/* Another release than before: what was kept for that one stays kept, so that it can be returned
 * to; what was kept for the one before it is so no longer, and other files are dropped. The same:
 * nothing changes, across restarts too. */
must_check int cache_use_release(struct cache *cache, struct hash root);

/* A whole file kept beside the objects as long as what is kept for its release: a release's locator
 * under its root hash. Errors as cache_get and cache_put. */
must_check int cache_get_file(struct cache *cache, struct hash name, struct buffer *out);
must_check int cache_put_file(struct cache *cache, struct hash name, struct bytes file);

/* Ends the transaction of writes. On failure what was put since the last one is not in the cache.
 */
must_check int cache_flush(struct cache *cache);
/* As cache_flush, and what is in the cache then survives a power cut: waits for the disk. */
must_check int cache_sync(struct cache *cache);
bool cache_needs_flush(const struct cache *cache);

uint64_t cache_refused_writes(const struct cache *cache); /* since create */
uint64_t cache_file_bytes(const struct cache *cache);     /* of PATH and PATH-wal now */
/* Counts rows: not for every second. */
void cache_figures(struct cache *cache, struct cache_figures *out);

#endif
