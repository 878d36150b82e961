#include "pipeline/sandbox.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <poll.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/pidfd.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"

#ifdef __SANITIZE_ADDRESS__
enum { ADDRESS_SPACE_IS_COUNTED = 0 };
#else
enum { ADDRESS_SPACE_IS_COUNTED = 1 };
#endif

enum { LOOK_EVERY_MS = 50 };

/* In shared memory: how the child ended, if it got there. */
struct outcome {
	bool finished;
	int rc;
	struct fault fault;
};

void *sandbox_shared_create(size_t size)
{
	void *shared = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);

	return shared == MAP_FAILED ? NULL : shared;
}

void sandbox_shared_destroy(void *shared, size_t size)
{
	if (shared)
		munmap(shared, size);
}

static void limit(int resource, rlim_t most)
{
	const struct rlimit both = { most, most };

	setrlimit((__rlimit_resource_t)resource, &both);
}

/* Foreign code likes to talk; what matters comes back as a fault. */
static void silence(void)
{
	int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);

	if (nowhere < 0)
		return;
	dup2(nowhere, STDOUT_FILENO);
	if (ADDRESS_SPACE_IS_COUNTED) /* else the sanitizer may have to say something */
		dup2(nowhere, STDERR_FILENO);
}

_Noreturn static void child(sandbox_work work, void *shared, const struct sandbox_options *options,
			    pid_t parent, struct outcome *outcome)
{
	struct fault fault = { "" };

	prctl(PR_SET_PDEATHSIG, SIGKILL);
	if (getppid() != parent)
		_exit(1);
	limit(RLIMIT_CORE, 0);
	limit(RLIMIT_CPU, options->timeout_s);
	if (ADDRESS_SPACE_IS_COUNTED)
		limit(RLIMIT_AS, options->memory_bytes);
	silence();
	outcome->rc = work(shared, &fault);
	outcome->fault = fault;
	outcome->finished = true;
	_exit(0); /* no destructors, no leak report: the process is thrown away */
}

static uint64_t resident_bytes(pid_t pid)
{
	char path[64];
	uint64_t size = 0, resident = 0;
	FILE *statm;

	snprintf(path, sizeof(path), "/proc/%d/statm", (int)pid);
	statm = fopen(path, "re");
	if (!statm)
		return 0;
	if (fscanf(statm, "%" SCNu64 " %" SCNu64, &size, &resident) != 2)
		resident = 0;
	fclose(statm);
	return resident * (uint64_t)sysconf(_SC_PAGESIZE);
}

/* Until the child ends, or has to be ended: 0, -ETIMEDOUT, -ENOMEM. */
static int watch(pid_t pid, int pid_fd, const struct sandbox_options *options)
{
	int64_t end_ms = clock_now_ms() + (int64_t)options->timeout_s * 1000;

	for (;;) {
		struct pollfd ended = { .fd = pid_fd, .events = POLLIN };
		int64_t left_ms = end_ms - clock_now_ms();

		if (left_ms <= 0)
			return -ETIMEDOUT;
		if (!ADDRESS_SPACE_IS_COUNTED && left_ms > LOOK_EVERY_MS)
			left_ms = LOOK_EVERY_MS;
		if (poll(&ended, 1, (int)left_ms) > 0)
			return 0;
		if (!ADDRESS_SPACE_IS_COUNTED && resident_bytes(pid) > options->memory_bytes)
			return -ENOMEM;
	}
}

static int judge(int watched, int status, const struct outcome *outcome,
		 const struct sandbox_options *options, const char *name, struct fault *fault)
{
	if (watched == -ETIMEDOUT || (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU))
		return fault_set(fault, -ETIMEDOUT,
				 "%s: reading it took over %" PRIu32
				 " s, so it was given up; it is "
				 "damaged or too large: export it as PLY",
				 name, options->timeout_s);
	if (watched == -ENOMEM)
		return fault_set(fault, -ENOMEM,
				 "%s: reading it took over %" PRIu64 " MiB, so it was given up; it "
				 "is damaged or too large: export it as PLY",
				 name, options->memory_bytes >> 20);
	if (watched < 0)
		return fault_set(fault, watched, "%s: %s", name, strerror(-watched));
	if (!outcome->finished)
		return fault_set(fault, -EBADMSG,
				 "%s: its reader crashed on it (%s); it is damaged: export it "
				 "again, or as PLY",
				 name,
				 WIFSIGNALED(status) ? strsignal(WTERMSIG(status)) : "it gave up");
	if (outcome->rc < 0)
		return fault_set(fault, outcome->rc, "%s", outcome->fault.text);
	return outcome->rc;
}

int sandbox_run(sandbox_work work, void *shared, const struct sandbox_options *options,
		const char *name, struct fault *fault)
{
	struct outcome *outcome = sandbox_shared_create(sizeof(*outcome));
	pid_t parent = getpid(), pid;
	int status = 0, pid_fd, rc;

	if (!outcome)
		return fault_set(fault, -ENOMEM, "%s: %s", name, strerror(ENOMEM));
	fflush(NULL); /* or the child holds a copy of what is not yet written */
	pid = fork();
	if (pid == 0)
		child(work, shared, options, parent, outcome);
	pid_fd = pid > 0 ? pidfd_open(pid, 0) : -1;
	rc = pid_fd < 0 ? -errno : watch(pid, pid_fd, options);
	if (pid > 0) {
		if (rc < 0)
			kill(pid, SIGKILL);
		while (waitpid(pid, &status, 0) < 0 && errno == EINTR)
			;
	}
	if (pid_fd >= 0)
		close(pid_fd);
	rc = judge(rc, status, outcome, options, name, fault);
	sandbox_shared_destroy(outcome, sizeof(*outcome));
	return rc;
}
