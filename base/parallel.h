/* Independent pieces of work on several threads. */
#ifndef GOPURA_BASE_PARALLEL_H
#define GOPURA_BASE_PARALLEL_H

#include <stdint.h>

#include "base/compiler.h"

/* One piece; worker is 0..worker_count-1, and no two pieces run with one number at a time. */
typedef int (*parallel_work)(void *user, uint32_t piece, uint32_t worker);

/* Pieces 0..piece_count-1, begun in this order; returns when all have ended. The failure of the
 * lowest piece that failed; after a failure no new piece is begun. */
must_check int parallel_run(uint32_t worker_count, uint32_t piece_count, parallel_work work,
			    void *user);

#endif
