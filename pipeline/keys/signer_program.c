/* The message is a file in memory, so that a program that reads late cannot block us. */
#include "pipeline/keys/signer_program.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"

extern char **environ;

static int message_file(struct bytes message)
{
	const int fd = memfd_create("gopura-message", MFD_CLOEXEC);
	int rc = fd < 0 ? -errno : bytes_write_to(fd, message);

	if (rc == 0 && lseek(fd, 0, SEEK_SET) < 0)
		rc = -errno;
	if (rc < 0 && fd >= 0)
		close(fd);
	return rc < 0 ? rc : fd;
}

/* Reads until the program closes its output. */
static int read_all(struct buffer *out, int fd, int64_t until_ms)
{
	uint8_t piece[4096];

	for (;;) {
		struct pollfd ready = { .fd = fd, .events = POLLIN };
		const int64_t left_ms = until_ms - clock_now_ms();
		ssize_t got;

		if (left_ms <= 0)
			return -ETIMEDOUT;
		if (poll(&ready, 1, (int)left_ms) <= 0)
			continue;
		got = read(fd, piece, sizeof(piece));
		if (got <= 0)
			return got < 0 ? -errno : 0;
		buffer_put(out, piece, (size_t)got);
		if (out->error)
			return out->error;
	}
}

static int start(pid_t *pid, const char *path, const char *name, int in, int out)
{
	char *const arguments[] = { (char *)path, (char *)name, NULL };
	posix_spawn_file_actions_t actions;
	int rc = posix_spawn_file_actions_init(&actions);

	if (rc != 0)
		return -rc;
	rc = posix_spawn_file_actions_adddup2(&actions, in, STDIN_FILENO);
	if (rc == 0)
		rc = posix_spawn_file_actions_adddup2(&actions, out, STDOUT_FILENO);
	if (rc == 0)
		rc = posix_spawn(pid, path, &actions, NULL, arguments, environ);
	posix_spawn_file_actions_destroy(&actions);
	return -rc;
}

/* Waits for the program, which may go on after it has closed its output. */
static int end(pid_t pid, int rc, int64_t until_ms)
{
	int status = 0;
	pid_t ended;

	while ((ended = waitpid(pid, &status, WNOHANG)) == 0 && rc == 0) {
		if (clock_now_ms() >= until_ms)
			rc = -ETIMEDOUT;
		else
			poll(NULL, 0, 10);
	}
	if (ended == 0) {
		kill(pid, SIGKILL);
		waitpid(pid, &status, 0);
	}
	if (rc < 0)
		return rc;
	return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? 0 : -EIO;
}

int signer_program_run(struct buffer *out, const char *path, const char *name, struct bytes message,
		       int timeout_s)
{
	const int64_t until_ms = clock_now_ms() + (int64_t)timeout_s * 1000;
	const int in = message_file(message);
	int answer[2], rc;
	pid_t pid;

	if (in < 0)
		return in;
	if (pipe2(answer, O_CLOEXEC) < 0) {
		rc = -errno;
		close(in);
		return rc;
	}
	rc = start(&pid, path, name, in, answer[1]);
	close(in);
	close(answer[1]);
	if (rc == 0)
		rc = end(pid, read_all(out, answer[0], until_ms), until_ms);
	close(answer[0]);
	return rc;
}
