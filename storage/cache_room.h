/* Keeps the cache within its budget. Private to storage/cache*.c. */
#ifndef GOPURA_STORAGE_CACHE_ROOM_H
#define GOPURA_STORAGE_CACHE_ROOM_H

#include "storage/cache_private.h"

must_check int cache_begin(struct cache *cache); /* begins a transaction if none is open */
/* Ends the transaction if that many more changed pages would make it too long. */
must_check int cache_reserve_pages(struct cache *cache, int64_t pages);
/* Counts changed pages, and ends a transaction that has become too long. */
must_check int cache_count_pages(struct cache *cache, int64_t pages);
/* Evicts until that many pages are free; a transaction is then open. Returns -EDQUOT if everything
 * that is left is kept. */
must_check int cache_make_room(struct cache *cache, int64_t pages);
/* Returns how many pages may still be written within the budget. */
int64_t cache_free_pages(struct cache *cache);
int64_t cache_tick(const struct cache *cache); /* seconds of use */
/* Returns pages to the disk if the file is larger than the budget now allows. */
void cache_shrink(struct cache *cache);

#endif
