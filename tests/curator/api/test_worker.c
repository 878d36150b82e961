#include "curator/api/worker.h"

#include <errno.h>
#include <pthread.h>
#include <semaphore.h>

#include "tests/check.h"

struct world {
	sem_t woken, gate;
	int handled;
};

static void wake(void *user)
{
	struct world *world = user;

	sem_post(&world->woken);
}

static void handle(void *user, const struct api_request *request, struct api_response *response)
{
	struct world *world = user;

	(void)request;
	sem_wait(&world->gate);
	__atomic_add_fetch(&world->handled, 1, __ATOMIC_SEQ_CST);
	api_fail(response, 404, "nothing");
}

static const struct api_route route = { API_GET, "/", ROLE_NONE, 0, true, handle };

static struct api_job *job_of(struct world *world)
{
	struct api_job *job = api_job_create();

	CHECK(job);
	job->route = &route;
	job->user = world;
	return job;
}

static struct workers *start(struct world *world, uint32_t threads)
{
	struct workers *workers;

	sem_init(&world->woken, 0, 0);
	sem_init(&world->gate, 0, 0);
	world->handled = 0;
	CHECK(workers_create(&workers, threads, wake, world) == 0);
	return workers;
}

static void a_job_is_answered_on_another_thread(void **state)
{
	struct world world;
	struct workers *workers = start(&world, 2);
	struct api_job *job = job_of(&world);

	(void)state;
	CHECK(workers_begin(workers, job) == 0);
	CHECK(!workers_ended(workers, job));
	sem_post(&world.gate);
	sem_wait(&world.woken);
	CHECK(workers_ended(workers, job) && job->response.status == 404);
	api_job_destroy(job);
	workers_destroy(workers);
}

static void a_job_that_waits_and_is_abandoned_never_runs(void **state)
{
	struct world world;
	struct workers *workers = start(&world, 1);
	struct api_job *first = job_of(&world);

	(void)state;
	CHECK(workers_begin(workers, first) == 0);
	for (int n = 0; n < 3; n++) {
		struct api_job *job = job_of(&world);

		CHECK(workers_begin(workers, job) == 0);
		workers_abandon(workers, job);
	}
	sem_post(&world.gate);
	sem_wait(&world.woken);
	CHECK(workers_ended(workers, first));
	workers_abandon(workers, first);
	workers_destroy(workers);
	CHECK(world.handled == 1);
}

static void a_job_that_runs_and_is_abandoned_is_ended(void **state)
{
	struct world world;
	struct workers *workers = start(&world, 1);
	struct api_job *job = job_of(&world);

	(void)state;
	CHECK(workers_begin(workers, job) == 0);
	workers_abandon(workers, job);
	sem_post(&world.gate);
	workers_destroy(workers);
	CHECK(world.handled <= 1); /* whether it had begun is chance; that it leaks is not */
}

static void only_so_many_jobs_may_wait(void **state)
{
	struct world world;
	struct workers *workers = start(&world, 1);
	struct api_job *jobs[WORKER_JOBS_MAX + 2];
	unsigned begun = 0;
	int rc = 0;

	(void)state;
	while (rc == 0 && begun < ARRAY_COUNT(jobs)) {
		jobs[begun] = job_of(&world);
		rc = workers_begin(workers, jobs[begun]);
		begun++;
	}
	CHECK(rc == -EBUSY && begun >= WORKER_JOBS_MAX + 1);
	for (unsigned n = 0; n < begun; n++)
		sem_post(&world.gate);
	workers_end(workers);
	CHECK(workers_begin(workers, jobs[begun - 1]) == -EBUSY);
	for (unsigned n = 0; n < begun; n++) {
		CHECK(workers_ended(workers, jobs[n]));
		api_job_destroy(jobs[n]);
	}
	workers_destroy(workers);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_job_is_answered_on_another_thread),
		cmocka_unit_test(a_job_that_waits_and_is_abandoned_never_runs),
		cmocka_unit_test(a_job_that_runs_and_is_abandoned_is_ended),
		cmocka_unit_test(only_so_many_jobs_may_wait),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
