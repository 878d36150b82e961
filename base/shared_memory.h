/* Memory that a process shares with those it forks later. */
#ifndef GOPURA_BASE_SHARED_MEMORY_H
#define GOPURA_BASE_SHARED_MEMORY_H

#include <stddef.h>

/* Returns zeroed memory that processes forked later share with the caller; NULL if there is none.
 * Pages take memory when they are first written. */
void *shared_memory_create(size_t size);
void shared_memory_destroy(void *memory, size_t size); /* NULL is fine */

#endif
