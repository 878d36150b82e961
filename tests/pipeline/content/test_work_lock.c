#include "pipeline/content/work_lock.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/check.h"

static struct content content;

static int set_up(void **state)
{
	(void)state;
	snprintf(content.folder, sizeof(content.folder), "/tmp/gopura-lock-XXXXXX");
	return mkdtemp(content.folder) ? 0 : -1;
}

static int tear_down(void **state)
{
	char command[100];

	(void)state;
	snprintf(command, sizeof(command), "rm -rf '%.60s'", content.folder);
	return system(command);
}

/* What another process gets. */
static int lock_elsewhere(void)
{
	int status, fd;
	pid_t child = fork();

	CHECK(child >= 0);
	if (child == 0) {
		int rc = work_lock(&fd, &content);

		_exit(rc == 0 ? 0 : rc == -EBUSY ? 1 : 2);
	}
	CHECK(waitpid(child, &status, 0) == child && WIFEXITED(status));
	return WEXITSTATUS(status);
}

static void keeps_other_processes_out_until_let_go(void **state)
{
	int fd;

	(void)state;
	CHECK(lock_elsewhere() == 0);
	CHECK(work_lock(&fd, &content) == 0); /* it died: free again */
	CHECK(lock_elsewhere() == 1);
	close(fd);
	CHECK(lock_elsewhere() == 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(keeps_other_processes_out_until_let_go, set_up,
						tear_down),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
