/* Fork, exec, wait. */
#include "curator/publish/content_run.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/utf8.h"

enum { ARGUMENTS_MAX = 16, LAST_BYTES = 4096 };

/* A comment that begins with a dash stays a comment: it follows its option as one word. */
static void set_arguments(const char *arguments[ARGUMENTS_MAX],
			  const struct content_run_options *options, char sequence[32])
{
	unsigned n = 0;

	arguments[n++] = "gopura-content";
	arguments[n++] = options->renew || options->sequence > 0 ? "publish" : "build";
	arguments[n++] = options->folder;
	arguments[n++] = "--out";
	arguments[n++] = options->release;
	if (options->keys) {
		arguments[n++] = "--keys";
		arguments[n++] = options->keys;
	}
	if (*options->comment) {
		arguments[n++] = "--comment";
		arguments[n++] = options->comment;
	}
	if (options->renew) {
		arguments[n++] = "--renew";
	} else if (options->sequence > 0) {
		snprintf(sequence, 32, "%" PRIu64, options->sequence);
		arguments[n++] = "--sequence";
		arguments[n++] = sequence;
	} else if (options->jobs) {
		arguments[n++] = "--jobs";
		arguments[n++] = options->jobs;
	}
	arguments[n] = NULL;
}

static int open_log(const struct content_run_options *options, int flags)
{
	char path[PATH_MAX];
	int rc = publish_file_path(path, options->folder, options->renew ? "renewal.log" : "log");
	int fd = rc < 0 ? rc : open(path, flags | O_CLOEXEC | O_NOFOLLOW, 0644);

	return fd < 0 && rc == 0 ? -errno : fd;
}

/* In the child. */
static void become_content(const struct content_run_options *options, int log_fd, pid_t parent)
{
	const char *arguments[ARGUMENTS_MAX];
	char sequence[32];
	sigset_t none;

	prctl(PR_SET_PDEATHSIG, SIGKILL);
	if (getppid() != parent)
		_exit(127); /* it was killed before that */
	/* Its lines are for people, who read them on the page, and not for the journal, which would
	 * get the number of a level in the place of "error: ". */
	unsetenv("JOURNAL_STREAM");
	sigemptyset(&none);
	sigprocmask(SIG_SETMASK, &none, NULL);
	set_arguments(arguments, options, sequence);
	if (dup2(log_fd, STDOUT_FILENO) < 0 || dup2(log_fd, STDERR_FILENO) < 0)
		_exit(127);
	execv(options->program, (char *const *)arguments);
	dprintf(STDERR_FILENO, "%s: %s\n", options->program, strerror(errno));
	_exit(127);
}

/* Keeps a line as a message, which readers of state.json take only if it is UTF-8 and fits. */
static void keep_line(char *message, char *line)
{
	utf8_make_printable(line);
	utf8_cut(line, PUBLISH_MESSAGE_BYTES - 1);
	memcpy(message, line, strlen(line) + 1);
}

/* The last line that says an error, else the last line. */
static void find_cause(const struct content_run_options *options, char *message)
{
	char text[LAST_BYTES + 1], *line, *rest = text;
	int fd = open_log(options, O_RDONLY);
	ssize_t bytes = 0;

	message[0] = '\0';
	if (fd >= 0) {
		if (lseek(fd, -LAST_BYTES, SEEK_END) < 0)
			lseek(fd, 0, SEEK_SET);
		bytes = read(fd, text, LAST_BYTES);
		close(fd);
	}
	text[bytes > 0 ? bytes : 0] = '\0';
	while ((line = strsep(&rest, "\n")))
		if (*line &&
		    (strncmp(line, "error: ", 7) == 0 || strncmp(message, "error: ", 7) != 0))
			keep_line(message, line);
}

static int judge(int status, const struct content_run_options *options, char *message)
{
	if (WIFEXITED(status) && WEXITSTATUS(status) == 0)
		return 0;
	if (WIFSIGNALED(status))
		snprintf(message, PUBLISH_MESSAGE_BYTES,
			 "gopura-content was ended by signal %d, perhaps because memory is short: "
			 "publish again, it continues",
			 WTERMSIG(status));
	else
		find_cause(options, message);
	return -EIO;
}

/* Waits for the child, or for the end of the program, with which the child ends too. */
static int wait_for(pid_t child, const struct content_run_options *options, char *message)
{
	const int child_fd = (int)syscall(SYS_pidfd_open, child, 0);
	struct pollfd fds[] = { { .fd = child_fd, .events = POLLIN },
				{ .fd = options->stop_fd, .events = POLLIN } };
	bool stopped = false;
	int status;

	if (child_fd >= 0) {
		while (poll(fds, 2, -1) < 0 && errno == EINTR)
			;
		stopped = fds[0].revents == 0;
		close(child_fd);
	}
	if (stopped)
		kill(child, SIGKILL); /* it leaves a whole release at any moment */
	if (waitpid(child, &status, 0) < 0)
		return -errno;
	return stopped ? -ECANCELED : judge(status, options, message);
}

int content_run(const struct content_run_options *options, char message[PUBLISH_MESSAGE_BYTES])
{
	const pid_t parent = getpid();
	int log_fd = open_log(options, O_WRONLY | O_CREAT | O_TRUNC);
	pid_t child;

	message[0] = '\0';
	if (log_fd < 0) {
		snprintf(message, PUBLISH_MESSAGE_BYTES, "log: %s", strerror(-log_fd));
		return -EIO;
	}
	child = fork();
	if (child == 0)
		become_content(options, log_fd, parent);
	close(log_fd);
	if (child < 0) {
		snprintf(message, PUBLISH_MESSAGE_BYTES, "fork: %s", strerror(errno));
		return -EIO;
	}
	return wait_for(child, options, message);
}
