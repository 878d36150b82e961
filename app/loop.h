/* An event loop: waits for the descriptors of all sources with one epoll, dispatches those that are
 * readable, then gives every task its turn. Both tables are fixed from the start. One thread. */
#ifndef GOPURA_APP_LOOP_H
#define GOPURA_APP_LOOP_H

#include <stdbool.h>
#include <stdint.h>

#include "base/compiler.h"

enum { LOOP_SOURCES_MAX = 16, LOOP_TASKS_MAX = 16 };

/* A module with a descriptor. */
struct loop_source {
	const char *name; /* for the log; borrowed */
	int fd;           /* borrowed; -1: there is none */
	/* Called with data while fd is readable. Returns 0; a negative errno ends the loop. */
	int (*dispatch)(void *data);
	void *data;
};

/* Something that is done by time, or after any event. */
struct loop_task {
	const char *name;
	/* Returns in how many milliseconds a turn has something to do by time alone; -1: never.
	 * NULL: never. */
	int (*wait_ms)(void *data);
	/* Called with data once per turn of the loop, in the order of the table. Returns 0; a
	 * negative errno ends the loop. */
	int (*turn)(void *data);
	void *data;
};

struct loop {
	struct loop_source sources[LOOP_SOURCES_MAX];
	struct loop_task tasks[LOOP_TASKS_MAX];
	uint32_t source_count, task_count;
	int epoll_fd;       /* 0: not created */
	const char *failed; /* name of the source or task that ended the loop; NULL: none did */
	bool quit;
};

/* Copies both tables; at most LOOP_SOURCES_MAX and LOOP_TASKS_MAX entries. Returns 0 or a negative
 * errno; call loop_finish in either case. */
must_check int loop_init(struct loop *loop, const struct loop_source *sources,
			 uint32_t source_count, const struct loop_task *tasks, uint32_t task_count);
void loop_finish(struct loop *loop); /* a zeroed struct is fine */
/* Runs until loop_quit was called or something failed. Returns 0 or the negative errno. */
must_check int loop_run(struct loop *loop);
/* Ends the loop: nothing else is called in this turn. Call it from a source or task. */
void loop_quit(struct loop *loop);

#endif
