/* Children that crash, and what they leave on standard error. */
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/crash.h"
#include "base/thread.h"
#include "tests/check.h"

#ifdef __SANITIZE_ADDRESS__
enum { SANITIZED = 1 };
#else
enum { SANITIZED = 0 };
#endif

static int *volatile nowhere;

static void *write_nowhere(void *data)
{
	*nowhere = 1;
	return data;
}

static void crash_in_a_thread(void)
{
	pthread_t thread;

	CHECK(thread_start(&thread, NULL, write_nowhere, NULL) == 0);
	pthread_join(thread, NULL);
}

static void crash_here(void)
{
	write_nowhere(NULL);
}

static int fill_stack(int depth)
{
	volatile char frame[4096];

	frame[0] = (char)depth;
	return depth < 0 ? 0 : fill_stack(depth + 1) + frame[0];
}

static void overflow(void)
{
	const struct rlimit limit = { 1 << 20, 1 << 20 };

	setrlimit(RLIMIT_STACK, &limit);
	nowhere = (void *)(intptr_t)fill_stack(0);
}

static void wait_for_the_watchdog(void)
{
	kill(getpid(), SIGABRT);
	for (;;)
		pause();
}

/* Returns the signal that ended the child; said is what it wrote. */
static int end_of(void (*crash)(void), char *said, size_t most)
{
	int ends[2], status;
	size_t size = 0;
	ssize_t got;
	pid_t pid;

	CHECK(pipe(ends) == 0);
	pid = fork();
	CHECK(pid >= 0);
	if (pid == 0) {
		const struct rlimit none = { 0, 0 };

		dup2(ends[1], STDERR_FILENO);
		setrlimit(RLIMIT_CORE, &none);
		for (int number = 1; number < 32; number++)
			signal(number, SIG_DFL);
		unsetenv("JOURNAL_STREAM");
		crash_tell("app");
		crash();
		_exit(0);
	}
	close(ends[1]);
	while (size < most - 1 && (got = read(ends[0], said + size, most - 1 - size)) > 0)
		size += (size_t)got;
	said[size] = '\0';
	close(ends[0]);
	CHECK(waitpid(pid, &status, 0) == pid);
	return WIFSIGNALED(status) ? WTERMSIG(status) : 0;
}

static void tells_where(void **state)
{
	static const struct {
		void (*crash)(void);
		int number;
		const char *line;
	} ways[] = {
		{ crash_here, SIGSEGV, "error: app: crashed by SIGSEGV; the calls, last first:\n" },
		{ crash_in_a_thread, SIGSEGV, "error: app: crashed by SIGSEGV; the calls" },
		{ overflow, SIGSEGV, "error: app: crashed by SIGSEGV; the calls" },
		{ abort, SIGABRT, "error: app: crashed by SIGABRT; the calls" },
		{ wait_for_the_watchdog, SIGABRT, "error: app: crashed by SIGABRT; the calls" },
	};
	char said[8192];

	(void)state;
	if (SANITIZED)
		skip();
	for (size_t i = 0; i < sizeof(ways) / sizeof(ways[0]); i++) {
		CHECK(end_of(ways[i].crash, said, sizeof(said)) == ways[i].number);
		CHECK(strncmp(said, ways[i].line, strlen(ways[i].line)) == 0);
		CHECK(strstr(said, "test_crash(+0x"));
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(tells_where) };

	return cmocka_run_group_tests(tests, NULL, NULL);
}
