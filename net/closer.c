/* Runs each close() on a detached thread with all signals blocked, and counts the threads that have
 * not finished. */
#include "net/closer.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdint.h>
#include <string.h>
#include <unistd.h>

#include "base/log.h"
#include "base/thread.h"

enum { STACK_BYTES = 256 << 10 };

/* running threads, plus descriptors for which no thread could be started */
static atomic_uint running;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER; /* of the next two */
static int waiting[CLOSER_THREADS_MAX];                  /* for a thread */
static unsigned waiting_count;

static void *close_one(void *data)
{
	close((int)(intptr_t)data);
	atomic_fetch_sub(&running, 1);
	return NULL;
}

/* The thread is detached: when the process exits, the thread ends too, even if its close()
 * hangs. */
static int start_thread(int fd)
{
	pthread_attr_t attributes;
	pthread_t thread;
	int rc;

	pthread_attr_init(&attributes);
	pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
	pthread_attr_setstacksize(&attributes, STACK_BYTES);
	rc = thread_start(&thread, &attributes, close_one, (void *)(intptr_t)fd);
	pthread_attr_destroy(&attributes);
	return rc;
}

/* Starts the threads that could not be started before. Returns 0 if none is left. */
static int start_waiting(void)
{
	int rc = 0;

	pthread_mutex_lock(&lock);
	while (rc == 0 && waiting_count > 0) {
		rc = start_thread(waiting[waiting_count - 1]);
		waiting_count -= rc == 0;
	}
	pthread_mutex_unlock(&lock);
	return rc;
}

void closer_close(int fd)
{
	int rc;

	if (fd < 0)
		return;
	atomic_fetch_add(&running, 1);
	pthread_mutex_lock(&lock);
	if (waiting_count < CLOSER_THREADS_MAX) /* else it stays open */
		waiting[waiting_count++] = fd;
	pthread_mutex_unlock(&lock);
	rc = start_waiting();
	if (rc < 0) /* an open descriptor is better than a loop that hangs */
		log_error("net", "cannot start the thread that closes descriptors: %s",
			  strerror(-rc));
}

bool closer_is_full(void)
{
	if (start_waiting() < 0)
		log_debug("net", "there is still no thread that closes descriptors");
	return atomic_load(&running) >= CLOSER_THREADS_MAX;
}
