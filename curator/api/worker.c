/* A queue of jobs, and the threads that take from it. */
#include "curator/api/worker.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>

enum { WORKERS_MAX = 8 };

struct workers {
	void (*wake)(void *user);
	void *user;
	pthread_t threads[WORKERS_MAX];
	uint32_t thread_count;
	pthread_mutex_t lock;
	pthread_cond_t changed;
	/* Under the lock. */
	struct api_job *first, *last; /* those that wait */
	uint32_t waiting;
	bool ending;
};

struct api_job *api_job_create(void)
{
	struct api_job *job = calloc(1, sizeof(*job));

	if (job)
		buffer_init(&job->response.body, API_RESPONSE_BYTES_MAX);
	return job;
}

void api_job_destroy(struct api_job *job)
{
	if (!job)
		return;
	buffer_finish(&job->request.body);
	buffer_finish(&job->response.body);
	free(job);
}

void api_job_run(struct api_job *job)
{
	job->route->handle(job->user, &job->request, &job->response);
}

/* Under the lock. NULL: the program ends. */
static struct api_job *take(struct workers *workers)
{
	struct api_job *job;

	while (!workers->first && !workers->ending)
		pthread_cond_wait(&workers->changed, &workers->lock);
	if (workers->ending)
		return NULL;
	job = workers->first;
	workers->first = job->next;
	if (!workers->first)
		workers->last = NULL;
	workers->waiting--;
	return job;
}

static void *work(void *user)
{
	struct workers *workers = user;
	struct api_job *job;
	bool abandoned;

	pthread_mutex_lock(&workers->lock);
	while ((job = take(workers))) {
		abandoned = job->abandoned;
		pthread_mutex_unlock(&workers->lock);
		if (!abandoned)
			api_job_run(job);
		pthread_mutex_lock(&workers->lock);
		job->under_way = false;
		if (job->abandoned)
			api_job_destroy(job);
		else
			workers->wake(workers->user);
	}
	pthread_mutex_unlock(&workers->lock);
	return NULL;
}

int workers_create(struct workers **out, uint32_t thread_count, void (*wake)(void *user),
		   void *user)
{
	struct workers *workers = calloc(1, sizeof(*workers));
	int rc = 0;

	*out = NULL;
	if (!workers)
		return -ENOMEM;
	workers->wake = wake;
	workers->user = user;
	pthread_mutex_init(&workers->lock, NULL);
	pthread_cond_init(&workers->changed, NULL);
	while (rc == 0 && workers->thread_count < thread_count &&
	       workers->thread_count < WORKERS_MAX) {
		rc = -pthread_create(&workers->threads[workers->thread_count], NULL, work, workers);
		if (rc == 0)
			workers->thread_count++;
	}
	if (rc < 0) {
		workers_destroy(workers);
		return rc;
	}
	*out = workers;
	return 0;
}

void workers_end(struct workers *workers)
{
	struct api_job *job;

	if (!workers)
		return;
	pthread_mutex_lock(&workers->lock);
	workers->ending = true;
	pthread_cond_broadcast(&workers->changed);
	pthread_mutex_unlock(&workers->lock);
	for (uint32_t n = 0; n < workers->thread_count; n++)
		pthread_join(workers->threads[n], NULL);
	workers->thread_count = 0;
	while ((job = workers->first)) {
		workers->first = job->next;
		job->under_way = false;
		if (job->abandoned)
			api_job_destroy(job);
	}
	workers->last = NULL;
}

void workers_destroy(struct workers *workers)
{
	if (!workers)
		return;
	workers_end(workers);
	pthread_cond_destroy(&workers->changed);
	pthread_mutex_destroy(&workers->lock);
	free(workers);
}

int workers_begin(struct workers *workers, struct api_job *job)
{
	int rc = 0;

	pthread_mutex_lock(&workers->lock);
	if (workers->ending || workers->waiting == WORKER_JOBS_MAX) {
		rc = -EBUSY;
	} else {
		job->under_way = true;
		job->next = NULL;
		*(workers->last ? &workers->last->next : &workers->first) = job;
		workers->last = job;
		workers->waiting++;
		pthread_cond_signal(&workers->changed);
	}
	pthread_mutex_unlock(&workers->lock);
	return rc;
}

bool workers_ended(struct workers *workers, const struct api_job *job)
{
	bool under_way;

	pthread_mutex_lock(&workers->lock);
	under_way = job->under_way;
	pthread_mutex_unlock(&workers->lock);
	return !under_way;
}

void workers_abandon(struct workers *workers, struct api_job *job)
{
	bool under_way;

	pthread_mutex_lock(&workers->lock);
	job->abandoned = true;
	under_way = job->under_way;
	pthread_mutex_unlock(&workers->lock);
	if (!under_way)
		api_job_destroy(job);
}
