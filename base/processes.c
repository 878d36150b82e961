/* Forks a process for each piece of work and waits for them. */
#include "base/processes.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/log.h"

enum { WORKERS_MAX = 64 };

struct running {
	pid_t pid;
	uint32_t piece;
	int alive; /* reading end of a pipe that closes when the process ends */
};

struct crew {
	const struct processes *plan;
	uint32_t begun_count;
	struct running running[WORKERS_MAX];
	uint32_t running_count;
	uint32_t failed_piece;
	int rc;
};

static void fail(struct crew *crew, uint32_t piece, int rc)
{
	if (crew->rc == 0 || piece < crew->failed_piece) {
		crew->rc = rc;
		crew->failed_piece = piece;
	}
}

static void be_worker(const struct processes *plan, uint32_t piece, pid_t parent)
{
	int rc;

	prctl(PR_SET_PDEATHSIG, SIGKILL);
	if (getppid() != parent)
		_exit(EIO);
	rc = plan->work(plan->user, piece);
	_exit(rc < 0 ? -rc : 0);
}

static void begin(struct crew *crew, uint32_t piece)
{
	pid_t parent = getpid(), pid;
	int ends[2];

	if (pipe2(ends, O_CLOEXEC) < 0) {
		fail(crew, piece, -errno);
		return;
	}
	pid = fork();
	if (pid == 0)
		be_worker(crew->plan, piece, parent);
	if (pid < 0)
		fail(crew, piece, -errno);
	close(ends[1]);
	if (pid < 0) {
		close(ends[0]);
		return;
	}
	crew->running[crew->running_count++] = (struct running){ pid, piece, ends[0] };
}

/* Takes the status of a process that has ended. */
static void end(struct crew *crew, struct running running)
{
	int status = 0;
	pid_t pid;

	do
		pid = waitpid(running.pid, &status, 0);
	while (pid < 0 && errno == EINTR);
	close(running.alive);
	if (pid < 0) {
		fail(crew, running.piece, -errno);
	} else if (!WIFEXITED(status)) {
		log_error("base", "a worker process was killed by signal %d", WTERMSIG(status));
		fail(crew, running.piece, -EIO);
	} else if (WEXITSTATUS(status) != 0) {
		fail(crew, running.piece, -WEXITSTATUS(status));
	} else {
		if (crew->plan->done)
			crew->plan->done(crew->plan->user, running.piece);
	}
}

/* Waits until at least one process has ended. */
static void wait_for_some(struct crew *crew)
{
	struct pollfd ends[WORKERS_MAX];
	uint32_t left = 0;

	for (uint32_t i = 0; i < crew->running_count; i++)
		ends[i] = (struct pollfd){ .fd = crew->running[i].alive, .events = POLLIN };
	if (poll(ends, crew->running_count, -1) < 0)
		return; /* interrupted */
	for (uint32_t i = 0; i < crew->running_count; i++) {
		if (ends[i].revents)
			end(crew, crew->running[i]);
		else
			crew->running[left++] = crew->running[i];
	}
	crew->running_count = left;
}

/* ---- the order of a shard */

void shard_order(struct shard shard, uint32_t *order, uint32_t piece_count)
{
	uint64_t count = shard.count > 1 ? shard.count : 1, number = count > 1 ? shard.number : 0;
	uint32_t first = (uint32_t)(piece_count * number / count);
	uint32_t own = (uint32_t)(piece_count * (number + 1) / count) - first;
	uint64_t random = number;

	for (uint32_t n = 0; n < piece_count; n++)
		order[n] = (uint32_t)(((uint64_t)first + n) % piece_count);
	/* Fisher and Yates, with the random numbers of Knuth's MMIX. */
	for (uint32_t left = piece_count - own; left > 1; left--) {
		uint32_t *last = &order[own + left - 1], *other, kept = *last;

		random = random * 6364136223846793005u + 1442695040888963407u;
		other = &order[own + (random >> 32) % left];
		*last = *other;
		*other = kept;
	}
}

/* ---- running */

static int run_all(struct crew *crew, const uint32_t *order)
{
	const struct processes *plan = crew->plan;
	uint32_t most = plan->worker_count < 1             ? 1
			: plan->worker_count > WORKERS_MAX ? WORKERS_MAX
							   : plan->worker_count;

	for (;;) {
		while (crew->rc == 0 && crew->running_count < most &&
		       crew->begun_count < plan->piece_count)
			begin(crew, order[crew->begun_count++]);
		if (crew->running_count == 0)
			return crew->rc;
		wait_for_some(crew);
	}
}

int processes_run(const struct processes *plan)
{
	uint32_t *order = malloc((plan->piece_count + (size_t)1) * sizeof(*order));
	struct crew crew = { .plan = plan };
	int rc = -ENOMEM;

	if (order) {
		shard_order(plan->shard, order, plan->piece_count);
		rc = run_all(&crew, order);
	}
	free(order);
	return rc;
}
