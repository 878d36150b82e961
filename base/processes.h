/* Runs pieces of work in processes of their own, each forked for one piece: what a piece allocates
 * goes with it, and libraries with state per process do not meet. Results travel in files or in
 * shared memory (base/shared_memory.h). To be called while the caller has one thread. */
#ifndef GOPURA_BASE_PROCESSES_H
#define GOPURA_BASE_PROCESSES_H

#include <stdint.h>

#include "base/compiler.h"

/* One of several machines that do the same pieces of work in a shared folder (docs/cluster.md). */
struct shard {
	uint32_t number, count; /* number < count; count 0 or 1: there is no other */
};

struct processes {
	uint32_t worker_count; /* most at one time; 64 at most, 0 counts as 1 */
	uint32_t piece_count;
	struct shard shard; /* decides the order only */
	/* Does one piece, in its process. Returns 0 or a negative errno, not below -255. */
	int (*work)(void *user, uint32_t piece);
	/* In the caller, after a piece has succeeded; may be NULL. */
	void (*done)(void *user, uint32_t piece);
	void *user;
};

/* Sets order to the pieces as a shard begins them: first its own part of the pieces in their order,
 * then all others, shuffled, for each shard in another way. So shards rarely work on the same
 * piece, and each of them alone does them all. */
void shard_order(struct shard shard, uint32_t *order, uint32_t piece_count);

/* Runs all pieces, begun in the order of shard_order. Returns 0, or the failure of the lowest
 * piece that failed; -EIO if a process was killed, -ENOMEM, or the errno of fork. After a failure
 * no new piece is begun. If the caller dies, the processes are killed. */
must_check int processes_run(const struct processes *processes);

#endif
