/* Distributes numbered pieces of work over threads with an atomic counter, and keeps the failure of
 * the lowest piece. */
#include "base/parallel.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdbool.h>

enum { WORKERS_MAX = 64 };

struct crew {
	parallel_work work;
	void *user;
	uint32_t piece_count;
	atomic_uint next;
	pthread_mutex_t lock; /* guards the fields below */
	uint32_t failed_piece;
	int rc;
};

struct worker {
	struct crew *crew;
	uint32_t number;
	pthread_t thread;
	bool started;
};

static bool has_failed(struct crew *crew)
{
	bool failed;

	pthread_mutex_lock(&crew->lock);
	failed = crew->rc < 0;
	pthread_mutex_unlock(&crew->lock);
	return failed;
}

static void *run_worker(void *user)
{
	struct worker *worker = user;
	struct crew *crew = worker->crew;

	while (!has_failed(crew)) {
		uint32_t piece = atomic_fetch_add(&crew->next, 1);
		int rc;

		if (piece >= crew->piece_count)
			break;
		rc = crew->work(crew->user, piece, worker->number);
		pthread_mutex_lock(&crew->lock);
		if (rc < 0 && (crew->rc == 0 || piece < crew->failed_piece)) {
			crew->rc = rc;
			crew->failed_piece = piece;
		}
		pthread_mutex_unlock(&crew->lock);
	}
	return NULL;
}

int parallel_run(uint32_t worker_count, uint32_t piece_count, parallel_work work, void *user)
{
	struct crew crew = { .work = work, .user = user, .piece_count = piece_count };
	struct worker workers[WORKERS_MAX];

	if (worker_count > WORKERS_MAX)
		worker_count = WORKERS_MAX;
	if (worker_count > piece_count)
		worker_count = piece_count;
	pthread_mutex_init(&crew.lock, NULL);
	/* The caller is worker 0. If a thread cannot be created, fewer workers do the work. */
	for (uint32_t i = 0; i < worker_count; i++) {
		workers[i] = (struct worker){ .crew = &crew, .number = i };
		if (i > 0)
			workers[i].started = pthread_create(&workers[i].thread, NULL, run_worker,
							    &workers[i]) == 0;
	}
	if (worker_count > 0)
		run_worker(&workers[0]);
	for (uint32_t i = 1; i < worker_count; i++)
		if (workers[i].started)
			pthread_join(workers[i].thread, NULL);
	pthread_mutex_destroy(&crew.lock);
	return crew.rc;
}

struct division {
	uint32_t item_count, range_items;
	parallel_range_work work;
	void *user;
};

static int run_range(void *user, uint32_t piece, uint32_t worker)
{
	const struct division *division = user;
	uint32_t first = piece * division->range_items, left = division->item_count - first;

	return division->work(division->user, first,
			      first + (left < division->range_items ? left : division->range_items),
			      worker);
}

int parallel_ranges(uint32_t worker_count, uint32_t item_count, uint32_t range_items,
		    parallel_range_work work, void *user)
{
	struct division division = { item_count, range_items, work, user };

	return parallel_run(worker_count, item_count / range_items + (item_count % range_items > 0),
			    run_range, &division);
}

uint32_t parallel_cores(void)
{
	cpu_set_t set;
	int count = sched_getaffinity(0, sizeof(set), &set) == 0 ? CPU_COUNT(&set) : 1;

	return count < 1 ? 1 : count > 8 ? 8 : (uint32_t)count;
}
