#include "pipeline/sandbox.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/check.h"

static const struct sandbox_options limits = { .timeout_s = 60, .memory_bytes = 1ull << 29 };
static const struct sandbox_options impatient = { .timeout_s = 1, .memory_bytes = 1ull << 29 };

static int gives_back(void *shared, struct fault *fault)
{
	(void)fault;
	memcpy(shared, "hello", 6);
	return 7;
}

static int refuses(void *shared, struct fault *fault)
{
	(void)shared;
	return fault_set(fault, -ENOSPC, "scan.obj: face 3 is odd");
}

static int crashes(void *shared, struct fault *fault)
{
	(void)shared;
	(void)fault;
	raise(SIGKILL); /* as the kernel does when memory runs out; sanitizers cannot catch it */
	return 0;
}

static int gives_up(void *shared, struct fault *fault)
{
	(void)shared;
	(void)fault;
	_exit(3);
}

static int hangs(void *shared, struct fault *fault)
{
	(void)shared;
	(void)fault;
	while (pause() < 0) /* always: no signal that is handled comes */
		;
	return 0;
}

/* Touches what it takes, for where resident memory is counted; ends itself where malloc fails. */
static int eats_memory(void *shared, struct fault *fault)
{
	(void)shared;
	for (int i = 0; i < 1024; i++) {
		char *more = malloc(1 << 24);

		if (!more)
			return fault_set(fault, -ENOMEM, "scan.obj: no memory");
		memset(more, i, 1 << 24);
		usleep(1000);
	}
	return 0;
}

static void gives_back_result_fault_and_shared_memory(void **state)
{
	char *shared = sandbox_shared_create(16);
	struct fault fault = { "" };
	(void)state;

	CHECK(sandbox_run(gives_back, shared, &limits, "scan.obj", &fault) == 7);
	CHECK(strcmp(shared, "hello") == 0 && fault.text[0] == '\0');
	CHECK(sandbox_run(refuses, shared, &limits, "scan.obj", &fault) == -ENOSPC);
	CHECK(strcmp(fault.text, "scan.obj: face 3 is odd") == 0);
	sandbox_shared_destroy(shared, 16);
}

static void an_end_of_the_child_is_a_fault_that_names_the_file(void **state)
{
	static const struct {
		sandbox_work work;
		const struct sandbox_options *limits;
		int rc;
		const char *says;
	} cases[] = {
		{ crashes, &limits, -EBADMSG, "crashed" },
		{ gives_up, &limits, -EBADMSG, "gave up" },
		{ hangs, &impatient, -ETIMEDOUT, "took over 1 s" },
		/* "no memory" by its own words, "took over 512 MiB" where it was watched */
		{ eats_memory, &limits, -ENOMEM, "o" },
	};
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		struct fault fault = { "" };
		int rc = sandbox_run(cases[i].work, NULL, cases[i].limits, "scan.obj", &fault);

		if (rc != cases[i].rc || strncmp(fault.text, "scan.obj: ", 10) != 0 ||
		    !strstr(fault.text + 10, cases[i].says))
			fail_msg("case %zu: rc %d, '%s'", i, rc, fault.text);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(gives_back_result_fault_and_shared_memory),
		cmocka_unit_test(an_end_of_the_child_is_a_fault_that_names_the_file),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
