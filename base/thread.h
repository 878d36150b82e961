/* Threads beside a program's loop, which handles its signals. */
#ifndef GOPURA_BASE_THREAD_H
#define GOPURA_BASE_THREAD_H

#include <pthread.h>

#include "base/compiler.h"

/* Starts a thread that takes no signals but those of its own crash (base/crash.h). attributes: NULL
 * is fine. Returns 0 or the negative error of pthread_create; then *thread is not set. */
must_check int thread_start(pthread_t *thread, const pthread_attr_t *attributes,
			    void *(*run)(void *), void *data);

#endif
