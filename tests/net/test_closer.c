/* Descriptors that are closed although no thread could be started for a while. */
#include "net/closer.h"

#include <errno.h>
#include <unistd.h>

#include "base/thread.h"
#include "tests/check.h"

static bool lacks_threads;

int thread_start(pthread_t *thread, const pthread_attr_t *attributes, void *(*run)(void *),
		 void *data)
{
	return lacks_threads ? -EAGAIN : -pthread_create(thread, attributes, run, data);
}

static void closes_later_what_no_thread_could_be_started_for(void **state)
{
	int ends[CLOSER_THREADS_MAX][2];
	char byte;

	(void)state;
	lacks_threads = true;
	for (int i = 0; i < CLOSER_THREADS_MAX; i++) {
		CHECK(pipe(ends[i]) == 0 && !closer_is_full());
		closer_close(ends[i][1]);
	}
	CHECK(closer_is_full());
	lacks_threads = false;
	for (int tries = 0; closer_is_full(); tries++) {
		CHECK(tries < 10000);
		usleep(1000);
	}
	for (int i = 0; i < CLOSER_THREADS_MAX; i++) {
		CHECK(read(ends[i][0], &byte, 1) == 0); /* its other end is closed */
		close(ends[i][0]);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(closes_later_what_no_thread_could_be_started_for),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
