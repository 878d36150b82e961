/* Forks a child with resource limits and the lockdown, serves its requests to open files over a
 * socket, and reports how it ended. */
#include "pipeline/import/sandbox.h"

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
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/log.h"
#include "base/proc_number.h"
#include "base/shared_memory.h"
#include "pipeline/import/lockdown.h"

#ifdef __SANITIZE_ADDRESS__
enum { ADDRESS_SPACE_IS_COUNTED = 0 };
#else
enum { ADDRESS_SPACE_IS_COUNTED = 1 };
#endif

enum {
	LOOK_EVERY_MS = 50,
	NAME_BYTES_MAX = 4096,
	OPENS_MAX = 10000, /* per child, over its lifetime */
	DESCRIPTORS_MAX = 64,
};

/* In shared memory: how the child ended. The state of the restrictions is stored before foreign
 * code runs. */
struct outcome {
	bool finished;
	int rc;
	/* from pipeline/import/lockdown.h: 0, or why the restriction is not active */
	int files_wall, calls_wall;
	struct diagnostic cause;
};

/* In the child: the socket on which it asks for files. */
static int asking_fd = -1;

static void limit(int resource, rlim_t most)
{
	const struct rlimit both = { most, most };

	setrlimit((__rlimit_resource_t)resource, &both);
}

/* Limits that the parent may raise later: pid 0 is the caller. The child cannot raise them, because
 * it may not ask the kernel for that once it is locked down. */
static void limit_softly(pid_t pid, int resource, rlim_t most)
{
	struct rlimit both;

	if (prlimit(pid, (__rlimit_resource_t)resource, NULL, &both) < 0)
		return;
	both.rlim_cur = most < both.rlim_max ? most : both.rlim_max;
	prlimit(pid, (__rlimit_resource_t)resource, &both, NULL);
}

static void apply(pid_t pid, const struct sandbox_limits *limits)
{
	limit_softly(pid, RLIMIT_CPU, limits->timeout_s);
	limit_softly(pid, RLIMIT_FSIZE, limits->memory_bytes); /* the result is a file in memory */
	if (ADDRESS_SPACE_IS_COUNTED)
		limit_softly(pid, RLIMIT_AS, limits->memory_bytes);
}

/* ---- files that the parent opens for the child: it receives a name and sends a descriptor */

union descriptor_room {
	struct cmsghdr align;
	char bytes[CMSG_SPACE(sizeof(int))];
};

/* Sends the result of an open: fd is the descriptor or a negative errno. Returns whether the child
 * has it. */
static bool send_opened(int socket, int fd)
{
	union descriptor_room room = { .bytes = { 0 } };
	struct iovec answer = { &fd, sizeof(fd) };
	struct msghdr message = { .msg_iov = &answer, .msg_iovlen = 1 };

	if (fd >= 0) {
		struct cmsghdr *control;

		message.msg_control = room.bytes;
		message.msg_controllen = sizeof(room.bytes);
		control = CMSG_FIRSTHDR(&message);
		control->cmsg_level = SOL_SOCKET;
		control->cmsg_type = SCM_RIGHTS;
		control->cmsg_len = CMSG_LEN(sizeof(int));
		memcpy(CMSG_DATA(control), &fd, sizeof(fd));
	}
	/* If the child does not listen any more, the way it ends tells why. */
	if (sendmsg(socket, &message, MSG_NOSIGNAL | MSG_DONTWAIT) >= 0)
		return true;
	log_debug("pipeline", "a reader process did not get its file: %s", strerror(errno));
	return false;
}

/* Runs in the parent: answers one request, which may raise *limits. Returns false if no more can be
 * answered. */
static bool answer_one(int socket, const struct sandbox_options *options, uint32_t *opens,
		       pid_t pid, struct sandbox_limits *limits)
{
	char name[NAME_BYTES_MAX + 1];
	ssize_t size = recv(socket, name, sizeof(name), MSG_DONTWAIT);
	int fd = -EACCES;

	if (size < 0)
		return errno == EAGAIN || errno == EINTR;
	if (size == 0)
		return false;
	if (size > NAME_BYTES_MAX)
		fd = -ENAMETOOLONG;
	else if (memchr(name, 0, (size_t)size))
		fd = -EINVAL;
	else if (++*opens > OPENS_MAX)
		fd = -EMFILE;
	else if (options->open) {
		name[size] = '\0';
		fd = options->open(options->open_data, name, limits);
		apply(pid, limits);
	}
	const bool is_sent = send_opened(socket, fd);

	if (fd >= 0)
		close(fd);
	return is_sent;
}

int sandbox_open(const char *name)
{
	size_t size = strlen(name);
	union descriptor_room room;
	int fd = -EIO;
	struct iovec answer = { &fd, sizeof(fd) };
	struct msghdr message = { .msg_iov = &answer,
				  .msg_iovlen = 1,
				  .msg_control = room.bytes,
				  .msg_controllen = sizeof(room.bytes) };
	const struct cmsghdr *control;

	if (size == 0 || size > NAME_BYTES_MAX)
		return size ? -ENAMETOOLONG : -ENOENT;
	if (asking_fd < 0)
		return -EIO;
	if (write(asking_fd, name, size) != (ssize_t)size ||
	    recvmsg(asking_fd, &message, MSG_CMSG_CLOEXEC) != (ssize_t)sizeof(fd)) {
		/* A later question would get the answer to this one. */
		close(asking_fd);
		asking_fd = -1;
		return -EIO;
	}
	control = CMSG_FIRSTHDR(&message);
	if (fd < 0)
		return fd;
	if (!control || control->cmsg_type != SCM_RIGHTS)
		return -EIO;
	memcpy(&fd, CMSG_DATA(control), sizeof(fd));
	return fd;
}

/* ---- the child */

/* Discards output of foreign code; everything important comes back as a diagnostic. */
static void silence(void)
{
	int nowhere = open("/dev/null", O_RDWR | O_CLOEXEC);

	if (nowhere < 0)
		return;
	dup2(nowhere, STDIN_FILENO);
	dup2(nowhere, STDOUT_FILENO);
	if (ADDRESS_SPACE_IS_COUNTED) /* otherwise the sanitizer may need to print */
		dup2(nowhere, STDERR_FILENO);
}

/* Closes all descriptors except the standard ones and these two. */
static void close_others(int a, int b)
{
	const int low = a < b ? a : b, high = a < b ? b : a;
	unsigned from = STDERR_FILENO + 1;

	if (low >= (int)from) {
		if (low > (int)from)
			close_range(from, (unsigned)low - 1, 0);
		from = (unsigned)low + 1;
	}
	if (high >= (int)from) {
		if (high > (int)from)
			close_range(from, (unsigned)high - 1, 0);
		from = (unsigned)high + 1;
	}
	close_range(from, ~0u, 0);
}

static void set_limits(const struct sandbox_options *options)
{
	limit(RLIMIT_CORE, 0);
	limit(RLIMIT_NPROC, 0);
	limit(RLIMIT_NOFILE, DESCRIPTORS_MAX);
	apply(0, &options->limits);
}

/* Where the child may ask the kernel for more, only what it cannot raise is a limit. */
static void harden_limits(void)
{
	static const int resources[] = { RLIMIT_CPU, RLIMIT_FSIZE, RLIMIT_AS };
	struct rlimit both;

	for (size_t i = 0; i < ARRAY_COUNT(resources); i++)
		if (getrlimit((__rlimit_resource_t)resources[i], &both) == 0)
			limit(resources[i], both.rlim_cur);
}

_Noreturn static void child(sandbox_work work, void *shared, const struct sandbox_options *options,
			    pid_t parent, struct outcome *outcome)
{
	struct diagnostics diagnostics = { 0 };

	prctl(PR_SET_PDEATHSIG, SIGKILL);
	if (getppid() != parent)
		_exit(1);
	silence();
	close_others(options->result_fd, asking_fd);
	set_limits(options);
	outcome->files_wall = lockdown_files();
	outcome->calls_wall = lockdown_calls();
	if (outcome->calls_wall < 0)
		harden_limits();
	outcome->rc = work(shared, &diagnostics);
	outcome->cause = diagnostics.first;
	outcome->finished = true;
	_exit(0); /* no destructors and no leak report, because the process is discarded */
}

/* ---- the parent */

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

/* Waits until the child ends (0) or must be killed (-ETIMEDOUT, -ENOMEM). */
static int watch(pid_t pid, int pid_fd, int socket, const struct sandbox_options *options,
		 struct sandbox_limits *limits)
{
	const int64_t began_ms = clock_now_ms();
	uint32_t opens = 0;

	for (;;) {
		struct pollfd news[] = { { .fd = pid_fd, .events = POLLIN },
					 { .fd = socket, .events = POLLIN } };
		int64_t left_ms = began_ms + (int64_t)limits->timeout_s * 1000 - clock_now_ms();

		if (left_ms <= 0)
			return -ETIMEDOUT;
		if (!ADDRESS_SPACE_IS_COUNTED && left_ms > LOOK_EVERY_MS)
			left_ms = LOOK_EVERY_MS;
		if (poll(news, ARRAY_COUNT(news), (int)left_ms) > 0) {
			if (news[0].revents)
				return 0;
			if (news[1].revents && !answer_one(socket, options, &opens, pid, limits)) {
				/* the child may wait for an answer */
				shutdown(socket, SHUT_RDWR);
				socket = -1; /* poll ignores it */
			}
		}
		if (!ADDRESS_SPACE_IS_COUNTED && resident_bytes(pid) > limits->memory_bytes)
			return -ENOMEM;
	}
}

/* Warns only once per process, because the kernel lacks it, not the scan. */
static void tell_walls(const struct outcome *outcome, const char *name)
{
	static bool was_told;

	log_debug("pipeline", "%s: sandbox of its reader: seccomp %s, Landlock %s", name,
		  outcome->calls_wall ? "absent" : "stands",
		  outcome->files_wall ? "absent" : "stands");
	if (outcome->calls_wall == 0 || was_told)
		return;
	was_told = true;
	log_warn("pipeline",
		 "this kernel cannot filter system calls (seccomp: %s), so foreign scans are read "
		 "with less protection",
		 strerror(-outcome->calls_wall));
}

static int judge(int watched, int status, struct outcome *outcome,
		 const struct sandbox_limits *limits, const char *name,
		 struct diagnostics *diagnostics)
{
	const int ended_by = WIFSIGNALED(status) ? WTERMSIG(status) : 0;

	if (watched == -ETIMEDOUT || ended_by == SIGXCPU)
		return diagnostics_add(diagnostics, -ETIMEDOUT, name, 0,
				       "reading it took over %" PRIu32
				       " s, so it was stopped; the file is "
				       "damaged or too large: export it as PLY",
				       limits->timeout_s);
	if (watched == -ENOMEM)
		return diagnostics_add(diagnostics, -ENOMEM, name, 0,
				       "reading it took over %" PRIu64
				       " MiB, so it was stopped; the "
				       "file is damaged or too large: export it as PLY",
				       limits->memory_bytes >> 20);
	if (watched < 0)
		return diagnostics_add(diagnostics, watched, name, 0, "%s", strerror(-watched));
	if (ended_by == SIGKILL)
		return diagnostics_add(
			diagnostics, -ENOMEM, name, 0,
			"its reader was killed, as the system does when memory runs "
			"out; end other programs and try again, or export it as PLY");
	if (!outcome->finished)
		return diagnostics_add(diagnostics, -EBADMSG, name, 0,
				       "its reader crashed (%s), so the file is damaged: export it "
				       "again, or as PLY",
				       ended_by ? strsignal(ended_by) : "the reader failed");
	outcome->cause.text[DIAGNOSTIC_BYTES - 1] = '\0';
	if (outcome->rc < 0 && outcome->cause.text[0])
		return diagnostics_add(diagnostics, outcome->rc, NULL, 0, "%s",
				       outcome->cause.text);
	return outcome->rc;
}

static int start_and_watch(sandbox_work work, void *shared, const struct sandbox_options *options,
			   struct outcome *outcome, struct sandbox_limits *limits, int *status)
{
	pid_t parent = getpid(), pid;
	int sockets[2], pid_fd, rc;

	if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, sockets) < 0)
		return -errno;
	fflush(NULL); /* otherwise the child inherits a copy of unwritten output */
	pid = fork();
	if (pid == 0) {
		asking_fd = sockets[1];
		child(work, shared, options, parent, outcome);
	}
	close(sockets[1]);
	pid_fd = pid > 0 ? pidfd_open(pid, 0) : -1;
	rc = pid_fd < 0 ? -errno : watch(pid, pid_fd, sockets[0], options, limits);
	if (pid > 0) {
		if (rc < 0)
			kill(pid, SIGKILL);
		while (waitpid(pid, status, 0) < 0 && errno == EINTR)
			;
	}
	if (pid_fd >= 0)
		close(pid_fd);
	close(sockets[0]);
	return rc;
}

int sandbox_run(sandbox_work work, void *shared, const struct sandbox_options *options,
		const char *name, struct diagnostics *diagnostics)
{
	struct outcome *outcome = shared_memory_create(sizeof(*outcome));
	struct sandbox_limits limits = options->limits;
	int status = 0, rc;

	if (!outcome)
		return diagnostics_add(diagnostics, -ENOMEM, name, 0, "%s", strerror(ENOMEM));
	rc = start_and_watch(work, shared, options, outcome, &limits, &status);
	if (rc == 0)
		tell_walls(outcome, name);
	rc = judge(rc, status, outcome, &limits, name, diagnostics);
	shared_memory_destroy(outcome, sizeof(*outcome));
	return rc;
}

uint64_t sandbox_memory_bytes(uint64_t more_bytes)
{
	unsigned long long own_kb;

	if (!proc_number("/proc/self/status",
			 ADDRESS_SPACE_IS_COUNTED ? "VmSize: %llu kB" : "VmRSS: %llu kB", &own_kb))
		own_kb = 0;
	return ((uint64_t)own_kb << 10) + more_bytes;
}
