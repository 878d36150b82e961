/* Runs independent pieces of work on several threads. */
#ifndef GOPURA_BASE_PARALLEL_H
#define GOPURA_BASE_PARALLEL_H

#include <stdint.h>

#include "base/compiler.h"

/* Does one piece. worker: 0 to worker_count - 1; no two pieces run with the same worker at one
 * time. Returns 0 or a negative errno. */
typedef int (*parallel_work)(void *user, uint32_t piece, uint32_t worker);

/* Runs pieces 0 to piece_count - 1, begun in this order, with at most worker_count workers (64 at
 * most), of which the caller is one. Returns when all have ended: 0, or the failure of the lowest
 * piece that failed. After a failure no new piece is begun. */
must_check int parallel_run(uint32_t worker_count, uint32_t piece_count, parallel_work work,
			    void *user);

/* Does items first to after - 1. worker as in parallel_work. Returns 0 or a negative errno. */
typedef int (*parallel_range_work)(void *user, uint32_t first, uint32_t after, uint32_t worker);

/* Divides items 0 to item_count - 1 into ranges of range_items each, the last one shorter, and runs
 * them as parallel_run does its pieces. first / range_items numbers a range. */
must_check int parallel_ranges(uint32_t worker_count, uint32_t item_count, uint32_t range_items,
			       parallel_range_work work, void *user);

/* Returns how many processors this process may use, at most 8: more would wait for memory. */
uint32_t parallel_cores(void);

#endif
