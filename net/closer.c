#include "net/closer.h"

#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdint.h>
#include <string.h>
#include <unistd.h>

#include "base/log.h"

enum { STACK_BYTES = 256 << 10 };

static atomic_uint running; /* threads, and descriptors that got none */

static void *close_one(void *data)
{
	close((int)(intptr_t)data);
	atomic_fetch_sub(&running, 1);
	return NULL;
}

/* A thread that nobody waits for: the end of the process ends it too, and a close that hangs. */
static int start_thread(int fd)
{
	pthread_attr_t attributes;
	pthread_t thread;
	sigset_t all, before;
	int rc;

	sigfillset(&all);
	pthread_attr_init(&attributes);
	pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
	pthread_attr_setstacksize(&attributes, STACK_BYTES);
	pthread_sigmask(SIG_SETMASK, &all, &before); /* signals are for the loop */
	rc = pthread_create(&thread, &attributes, close_one, (void *)(intptr_t)fd);
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	pthread_attr_destroy(&attributes);
	return rc;
}

void closer_close(int fd)
{
	int rc;

	if (fd < 0)
		return;
	atomic_fetch_add(&running, 1);
	rc = start_thread(fd);
	if (rc != 0) /* it stays open: rather that than a loop that hangs */
		log_error("net", "no thread to close a descriptor: %s", strerror(rc));
}

bool closer_is_full(void)
{
	return atomic_load(&running) >= CLOSER_THREADS_MAX;
}
