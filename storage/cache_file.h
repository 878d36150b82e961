/* Opens the cache's database and handles damage. Private to storage/cache*.c. */
#ifndef GOPURA_STORAGE_CACHE_FILE_H
#define GOPURA_STORAGE_CACHE_FILE_H

#include "storage/cache_private.h"

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

#endif
