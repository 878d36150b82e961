#include "pipeline/import/sandbox.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/mount.h>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/crash.h"
#include "base/shared_memory.h"
#include "pipeline/import/lockdown.h"
#include "tests/check.h"

static const struct sandbox_options limits = { .limits = { 60, 1ull << 29 } };
static const struct sandbox_options impatient = { .limits = { 1, 1ull << 29 } };

static int gives_back(void *shared, struct diagnostics *diagnostics)
{
	(void)diagnostics;
	memcpy(shared, "hello", 6);
	return 7;
}

static int refuses(void *shared, struct diagnostics *diagnostics)
{
	(void)shared;
	return diagnostics_add(diagnostics, -ENOSPC, NULL, 0, "scan.obj: face 3 is odd");
}

static int is_killed(void *shared, struct diagnostics *diagnostics)
{
	(void)shared;
	(void)diagnostics;
	raise(SIGKILL); /* as the kernel does when memory runs out */
	return 0;
}

static int reads_nowhere(void *shared, struct diagnostics *diagnostics)
{
	(void)shared;
	(void)diagnostics;
	raise(SIGSEGV);
	return 0;
}

static int gives_up(void *shared, struct diagnostics *diagnostics)
{
	(void)shared;
	(void)diagnostics;
	_exit(3);
}

static int hangs(void *shared, struct diagnostics *diagnostics)
{
	(void)shared;
	(void)diagnostics;
	while (pause() < 0) /* always: no signal that is handled comes */
		;
	return 0;
}

/* Its processor time ends at about the same time as that of the clock. */
static int spins(void *shared, struct diagnostics *diagnostics)
{
	(void)shared;
	(void)diagnostics;
	for (volatile bool spinning = true; spinning;)
		;
	return 0;
}

/* Touches what it takes, for where resident memory is counted; ends itself where malloc fails. */
static int eats_memory(void *shared, struct diagnostics *diagnostics)
{
	(void)shared;
	for (int i = 0; i < 1024; i++) {
		char *more = malloc(1 << 24);

		if (!more)
			return diagnostics_add(diagnostics, -ENOMEM, NULL, 0,
					       "scan.obj: no memory");
		memset(more, i, 1 << 24);
		usleep(1000);
	}
	return 0;
}

static void gives_back_result_fault_and_shared_memory(void **state)
{
	char *shared = shared_memory_create(16);
	struct diagnostics diagnostics = { 0 };
	(void)state;

	CHECK(sandbox_run(gives_back, shared, &limits, "scan.obj", &diagnostics) == 7);
	CHECK(strcmp(shared, "hello") == 0 && diagnostics.first.text[0] == '\0');
	CHECK(sandbox_run(refuses, shared, &limits, "scan.obj", &diagnostics) == -ENOSPC);
	CHECK(strcmp(diagnostics.first.text, "scan.obj: face 3 is odd") == 0);
	shared_memory_destroy(shared, 16);
}

static void an_end_of_the_child_is_a_fault_that_names_the_file(void **state)
{
	static const struct {
		sandbox_work work;
		const struct sandbox_options *limits;
		int rc;
		const char *says;
	} cases[] = {
		{ is_killed, &limits, -ENOMEM, "memory" },
		{ reads_nowhere, &limits, -EBADMSG, "crashed" },
		{ gives_up, &limits, -EBADMSG, "the reader failed" },
		{ hangs, &impatient, -ETIMEDOUT, "took over 1 s" },
		{ spins, &impatient, -ETIMEDOUT, "took over 1 s" },
		/* "no memory" by its own words, "took over 512 MiB" where it was watched */
		{ eats_memory, &limits, -ENOMEM, "o" },
	};
	(void)state;

	signal(SIGSEGV, SIG_DFL); /* cmocka has a handler of its own */
	crash_tell("pipeline");   /* as gopura-content does; what it writes goes nowhere */
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		struct diagnostics diagnostics = { 0 };
		int rc =
			sandbox_run(cases[i].work, NULL, cases[i].limits, "scan.obj", &diagnostics);

		if (rc != cases[i].rc || strncmp(diagnostics.first.text, "scan.obj: ", 10) != 0 ||
		    !strstr(diagnostics.first.text + 10, cases[i].says))
			fail_msg("case %zu: rc %d, '%s'", i, rc, diagnostics.first.text);
	}
}

/* ---- the walls */

static long opens_to_read(void)
{
	return open("/etc/passwd", O_RDONLY);
}

static long opens_to_write(void)
{
	return open("/tmp/gopura-sandbox-was-here", O_WRONLY | O_CREAT, 0600);
}

static long opens_in_the_newest_way(void)
{
	const uint64_t how[3] = { O_RDONLY };

	return syscall(SYS_openat2, AT_FDCWD, "/etc/passwd", how, sizeof(how));
}

static long looks_at_a_file(void)
{
	struct stat status;

	return stat("/etc/passwd", &status);
}

static long removes_a_file(void)
{
	return unlink("/tmp/gopura-sandbox-was-never-here");
}

static long takes_to_the_network(void)
{
	return socket(AF_INET, SOCK_STREAM, 0);
}

static long starts_a_process(void)
{
	return syscall(SYS_clone, SIGCHLD, 0, 0, 0, 0);
}

static long starts_a_program(void)
{
	char *const arguments[] = { "true", NULL }, *const environment[] = { NULL };

	return execve("/bin/true", arguments, environment);
}

static long signals_its_parent(void)
{
	return kill(getppid(), 0);
}

static long signals_a_thread_of_pid_1(void)
{
	return syscall(SYS_tgkill, 1, 1, 0);
}

static long is_traced(void)
{
	return ptrace(PTRACE_TRACEME, 0, NULL, NULL);
}

static long mounts(void)
{
	return mount("none", "/mnt", "tmpfs", 0, NULL);
}

static long maps_code(void)
{
	void *map = mmap(NULL, 4096, PROT_READ | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);

	return map == MAP_FAILED ? -1 : 0;
}

static long makes_memory_code(void)
{
	void *map = mmap(NULL, 4096, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);

	return map == MAP_FAILED ? 0 : mprotect(map, 4096, PROT_READ | PROT_EXEC);
}

static long makes_a_file_in_memory(void)
{
	return memfd_create("x", 0);
}

static long sends_without_a_filter(void)
{
	return syscall(SYS_io_uring_setup, 1, NULL);
}

static const struct {
	const char *name;
	long (*attempt)(void);
} attempts[] = {
	{ "open to read", opens_to_read },
	{ "open to write", opens_to_write },
	{ "openat2", opens_in_the_newest_way },
	{ "stat", looks_at_a_file },
	{ "unlink", removes_a_file },
	{ "socket", takes_to_the_network },
	{ "clone", starts_a_process },
	{ "execve", starts_a_program },
	{ "kill", signals_its_parent },
	{ "tgkill", signals_a_thread_of_pid_1 },
	{ "ptrace", is_traced },
	{ "mount", mounts },
	{ "mmap of code", maps_code },
	{ "mprotect to code", makes_memory_code },
	{ "memfd_create", makes_a_file_in_memory },
	{ "io_uring_setup", sends_without_a_filter },
};

/* shared: an errno for each attempt, 0 where it was allowed. */
static int tries_all(void *shared, struct diagnostics *diagnostics)
{
	int *errors = shared;
	(void)diagnostics;

	for (size_t i = 0; i < ARRAY_COUNT(attempts); i++) {
		errno = 0;
		errors[i] = attempts[i].attempt() < 0 ? errno : 0;
	}
	return 0;
}

/* Gives what the child exits with. */
static int in_a_child(int (*work)(void))
{
	int status = 0;
	pid_t pid = fork();

	CHECK(pid >= 0);
	if (pid == 0)
		_exit(work());
	CHECK(waitpid(pid, &status, 0) == pid && WIFEXITED(status));
	return WEXITSTATUS(status);
}

enum { HELD, ABSENT, BROKEN };

/* What was opened before stays usable. */
static int reads_what_is_open(int fd)
{
	char byte;

	return fd >= 0 && read(fd, &byte, 1) == 1;
}

static int lands_in_landlock(void)
{
	int fd = open("/etc/passwd", O_RDONLY | O_CLOEXEC);
	int rc = lockdown_files();

	if (rc == -EOPNOTSUPP)
		return ABSENT;
	return rc == 0 && reads_what_is_open(fd) && opens_to_read() < 0 && errno == EACCES &&
			       opens_to_write() < 0 && errno == EACCES &&
			       takes_to_the_network() >= 0
		       ? HELD
		       : BROKEN;
}

static int is_filtered(void)
{
	int fd = open("/etc/passwd", O_RDONLY | O_CLOEXEC);
	int rc = lockdown_calls();

	if (rc == -EOPNOTSUPP)
		return ABSENT;
	/* Nor can it ask for Landlock any more: to lockdown_files that is a kernel without. */
	return rc == 0 && reads_what_is_open(fd) && opens_to_read() < 0 && errno == EPERM &&
			       takes_to_the_network() < 0 && errno == EPERM &&
			       lockdown_files() == -EOPNOTSUPP
		       ? HELD
		       : BROKEN;
}

static void landlock_alone_closes_every_file(void **state)
{
	int held = in_a_child(lands_in_landlock);
	(void)state;

	if (held == ABSENT) {
		puts("this kernel has no Landlock");
		skip();
	}
	CHECK(held == HELD);
}

static void seccomp_alone_closes_files_and_network(void **state)
{
	int held = in_a_child(is_filtered);
	(void)state;

	if (held == ABSENT) {
		puts("this kernel has no seccomp");
		skip();
	}
	CHECK(held == HELD);
}

static void the_child_can_ask_the_kernel_for_nothing_else(void **state)
{
	const size_t size = ARRAY_COUNT(attempts) * sizeof(int);
	int *errors = shared_memory_create(size);
	struct diagnostics diagnostics = { 0 };
	(void)state;

	if (in_a_child(is_filtered) == ABSENT)
		skip();
	CHECK(sandbox_run(tries_all, errors, &limits, "scan.obj", &diagnostics) == 0);
	for (size_t i = 0; i < ARRAY_COUNT(attempts); i++)
		if (errors[i] != EPERM)
			fail_msg("%s: %s", attempts[i].name, strerror(errors[i]));
	shared_memory_destroy(errors, size);
}

/* ---- files that the parent opens */

static int opened; /* times, in the parent */

static int gives_one_file(void *data, const char *name, struct sandbox_limits *may)
{
	(void)may;
	opened++;
	if (strcmp(name, data) != 0)
		return -EXDEV;
	return open("/etc/passwd", O_RDONLY | O_CLOEXEC);
}

static int asks(void *shared, struct diagnostics *diagnostics)
{
	static char long_name[8000];
	int *told = shared;
	char text[5] = "";
	(void)diagnostics;

	memset(long_name, 'a', sizeof(long_name) - 1);
	for (int i = 0; i < 100; i++) { /* more than it may have open at once */
		int fd = sandbox_open("skin.jpg");

		told[0] = fd < 0 ? fd : (int)read(fd, text, 4);
		if (fd >= 0)
			close(fd);
	}
	told[1] = sandbox_open("../keys/release.key");
	told[2] = sandbox_open(long_name);
	told[3] = sandbox_open("");
	return 0;
}

static void the_parent_opens_what_it_likes_and_nothing_else(void **state)
{
	const struct sandbox_options open_limits = { .limits = { 60, 1ull << 29 },
						     .open = gives_one_file,
						     .open_data = "skin.jpg" };
	int *told = shared_memory_create(4 * sizeof(*told));
	struct diagnostics diagnostics = { 0 };
	(void)state;

	CHECK(sandbox_run(asks, told, &open_limits, "scan.obj", &diagnostics) == 0);
	CHECK(told[0] == 4 && told[1] == -EXDEV && told[2] == -ENAMETOOLONG && told[3] == -ENOENT);
	CHECK(opened == 101);
	/* Without a function of the parent: nothing. */
	CHECK(sandbox_run(asks, told, &limits, "scan.obj", &diagnostics) == 0);
	CHECK(told[0] == -EACCES && told[1] == -EACCES && opened == 101);
	shared_memory_destroy(told, 4 * sizeof(*told));
}

static int gives_more(void *data, const char *name, struct sandbox_limits *may)
{
	(void)data;
	(void)name;
	may->memory_bytes += 1ull << 30;
	may->timeout_s += 60;
	return open("/etc/passwd", O_RDONLY | O_CLOEXEC);
}

static int needs_more(void *shared, struct diagnostics *diagnostics)
{
	const size_t size = 1 << 29;
	const int fd = sandbox_open("skin.jpg");
	char *room = malloc(size);
	int *was_long = shared;

	if (fd < 0 || !room)
		return diagnostics_add(diagnostics, -ENOMEM, NULL, 0, "scan.obj: no memory");
	memset(room, 1, size);
	close(fd);
	free(room);
	usleep(1500000);
	*was_long = 1;
	return 0;
}

static void what_the_parent_opens_may_raise_the_limits(void **state)
{
	const struct sandbox_options little = { .limits = { 1, sandbox_memory_bytes(1 << 26) },
						.open = gives_more };
	int *was_long = shared_memory_create(sizeof(*was_long));
	struct diagnostics diagnostics = { 0 };
	int rc;
	(void)state;

	rc = sandbox_run(needs_more, was_long, &little, "scan.obj", &diagnostics);
	if (rc < 0)
		fail_msg("%s", diagnostics.first.text);
	CHECK(*was_long == 1);
	shared_memory_destroy(was_long, sizeof(*was_long));
}

static int reads_foreign_descriptors(void *shared, struct diagnostics *diagnostics)
{
	const int *fds = shared;
	char byte;
	(void)diagnostics;

	return (read(fds[0], &byte, 1) < 0 && errno == EBADF) + 2 * (write(fds[1], "x", 1) == 1) +
	       4 * (read(STDIN_FILENO, &byte, 1) == 0);
}

static void of_descriptors_only_the_result_stays_open(void **state)
{
	struct sandbox_options own = limits;
	int *fds = shared_memory_create(2 * sizeof(*fds));
	struct diagnostics diagnostics = { 0 };
	(void)state;

	fds[0] = open("/etc/passwd", O_RDONLY); /* without O_CLOEXEC, as a library may */
	fds[1] = own.result_fd = memfd_create("result", 0);
	CHECK(fds[0] >= 0 && fds[1] >= 0);
	CHECK(sandbox_run(reads_foreign_descriptors, fds, &own, "scan.obj", &diagnostics) == 7);
	CHECK(lseek(fds[1], 0, SEEK_END) == 1);
	close(fds[0]);
	close(fds[1]);
	shared_memory_destroy(fds, 2 * sizeof(*fds));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(gives_back_result_fault_and_shared_memory),
		cmocka_unit_test(an_end_of_the_child_is_a_fault_that_names_the_file),
		cmocka_unit_test(landlock_alone_closes_every_file),
		cmocka_unit_test(seccomp_alone_closes_files_and_network),
		cmocka_unit_test(the_child_can_ask_the_kernel_for_nothing_else),
		cmocka_unit_test(the_parent_opens_what_it_likes_and_nothing_else),
		cmocka_unit_test(what_the_parent_opens_may_raise_the_limits),
		cmocka_unit_test(of_descriptors_only_the_result_stays_open),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
