/* Threads on which slow handlers run. */
#ifndef GOPURA_CURATOR_API_WORKER_H
#define GOPURA_CURATOR_API_WORKER_H

#include "curator/api/route.h"

enum { WORKER_JOBS_MAX = 64 }; /* that wait */

/* A request on its way to its response. */
struct api_job {
	const struct api_route *route;
	void *user; /* of the route */
	struct api_request request;
	struct api_response response;
	/* Private, under the workers' lock. */
	struct api_job *next;
	bool under_way, abandoned;
};

/* Returns an empty job, owned by the caller; NULL: no memory is left. */
struct api_job *api_job_create(void);
void api_job_destroy(struct api_job *job); /* not while it is under way; NULL is fine */
/* Calls the handler on this thread. */
void api_job_run(struct api_job *job);

struct workers;

/* Starts the threads. wake is called by one of them when a job has ended. *out is owned by the
 * caller; NULL on failure. -ENOMEM, or the errno of pthread_create. */
must_check int workers_create(struct workers **out, uint32_t thread_count, void (*wake)(void *user),
			      void *user);
/* Waits for the jobs that run, and drops those that wait: no job is under way after it, and none
 * can begin. NULL is fine. */
void workers_end(struct workers *workers);
void workers_destroy(struct workers *workers); /* ends them first; NULL is fine */

/* Gives a job to a thread; it stays the caller's, who leaves it alone until workers_ended says so.
 * -EBUSY: too many wait, or the workers have ended. */
must_check int workers_begin(struct workers *workers, struct api_job *job);
/* Returns whether a job that was begun has its response. */
bool workers_ended(struct workers *workers, const struct api_job *job);
/* Takes a job whose response nobody waits for any more: it is destroyed, now or when it has ended.
 */
void workers_abandon(struct workers *workers, struct api_job *job);

#endif
