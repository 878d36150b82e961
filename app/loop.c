/* The event loop: epoll over the sources, with the earliest deadline of the tasks as its timeout.
 */
#include "app/loop.h"

#include <assert.h>
#include <errno.h>
#include <string.h>
#include <sys/epoll.h>
#include <unistd.h>

#include "base/clock.h"

static int watch(struct loop *loop, struct loop_source *source)
{
	struct epoll_event event = { .events = EPOLLIN, .data.ptr = source };

	if (source->fd < 0)
		return 0;
	return epoll_ctl(loop->epoll_fd, EPOLL_CTL_ADD, source->fd, &event) < 0 ? -errno : 0;
}

int loop_init(struct loop *loop, const struct loop_source *sources, uint32_t source_count,
	      const struct loop_task *tasks, uint32_t task_count)
{
	int rc = 0;

	assert(source_count <= LOOP_SOURCES_MAX && task_count <= LOOP_TASKS_MAX);
	*loop = (struct loop){ .source_count = source_count, .task_count = task_count };
	memcpy(loop->sources, sources, source_count * sizeof(*sources));
	memcpy(loop->tasks, tasks, task_count * sizeof(*tasks));
	loop->epoll_fd = epoll_create1(EPOLL_CLOEXEC);
	if (loop->epoll_fd < 0)
		return -errno;
	for (uint32_t i = 0; i < source_count && rc == 0; i++)
		rc = watch(loop, &loop->sources[i]);
	return rc;
}

void loop_finish(struct loop *loop)
{
	if (loop->epoll_fd > 0)
		close(loop->epoll_fd);
	loop->epoll_fd = 0;
}

static int wait_ms(const struct loop *loop)
{
	int soonest_ms = -1;

	for (uint32_t i = 0; i < loop->task_count; i++) {
		const struct loop_task *task = &loop->tasks[i];

		if (task->wait_ms)
			soonest_ms = clock_sooner_ms(soonest_ms, task->wait_ms(task->data));
	}
	return soonest_ms;
}

static int turn(struct loop *loop)
{
	struct epoll_event ready[LOOP_SOURCES_MAX];
	const int count = epoll_wait(loop->epoll_fd, ready, LOOP_SOURCES_MAX, wait_ms(loop));
	int rc = 0;

	if (count < 0)
		return errno == EINTR ? 0 : -errno;
	for (int i = 0; i < count && rc == 0 && !loop->quit; i++) {
		const struct loop_source *source = ready[i].data.ptr;

		rc = source->dispatch(source->data);
		if (rc < 0)
			loop->failed = source->name;
	}
	for (uint32_t i = 0; i < loop->task_count && rc == 0 && !loop->quit; i++) {
		const struct loop_task *task = &loop->tasks[i];

		rc = task->turn(task->data);
		if (rc < 0)
			loop->failed = task->name;
	}
	return rc;
}

int loop_run(struct loop *loop)
{
	int rc = 0;

	while (rc == 0 && !loop->quit)
		rc = turn(loop);
	return rc;
}

void loop_quit(struct loop *loop)
{
	loop->quit = true;
}
