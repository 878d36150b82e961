#include "curator/publish/content_run.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/curator/publish/publish_folder.h"

/* Runs a script in the place of gopura-content, which must fail. */
static void run(const char *script, char message[PUBLISH_MESSAGE_BYTES])
{
	char program[128], text[2048];
	const struct content_run_options options = { .program = program,
						     .folder = folder,
						     .release = folder,
						     .comment = "",
						     .stop_fd = -1 };
	const int bytes = snprintf(text, sizeof(text), "#!/bin/sh\n%s\nexit 1\n", script);

	snprintf(program, sizeof(program), "%s/program", folder);
	CHECK(bytes < (int)sizeof(text));
	CHECK(bytes_write_file((struct bytes){ (const uint8_t *)text, (size_t)bytes }, program) ==
	      0);
	CHECK(chmod(program, 0755) == 0);
	CHECK(content_run(&options, message) == -EIO);
}

/* A message that its own reader refused would be a damaged state, and the request taken for new. */
static void check_kept(const char *message)
{
	struct publish_state written = { .step = PUBLISH_FAILED }, now;

	memcpy(written.message, message, strlen(message) + 1);
	CHECK(publish_state_write(&written, folder) == 0);
	CHECK(publish_state_read(&now, folder) == 0 && strcmp(now.message, message) == 0);
}

static void the_cause_is_the_last_error(void **state)
{
	char message[PUBLISH_MESSAGE_BYTES];

	(void)state;
	run("echo 'error: pipeline: parts.json:3: a slip'; echo 'info: pipeline: an end'", message);
	CHECK(strcmp(message, "error: pipeline: parts.json:3: a slip") == 0);
	run("echo 'info: pipeline: an end'", message);
	CHECK(strcmp(message, "info: pipeline: an end") == 0);
}

static void a_cause_of_any_bytes_can_be_kept(void **state)
{
	char message[PUBLISH_MESSAGE_BYTES];

	(void)state;
	run("printf 'error: \\t\\033[1m\\377 not UTF-8\\n'", message);
	CHECK(strcmp(message, "error: ??[1m? not UTF-8") == 0);
	check_kept(message);
	for (int before = 0; before < 3; before++) { /* the end falls on each byte of a letter */
		char script[128];

		snprintf(script, sizeof(script),
			 "printf 'error: %.*s'; for n in $(seq 300); do printf '\\341\\236\\200'; "
			 "done; echo",
			 before, "xx");
		run(script, message);
		CHECK(strlen(message) > PUBLISH_MESSAGE_BYTES - 4);
		check_kept(message);
	}
}

/* What the program writes goes to a log that people read, not to the journal. */
static void a_service_hides_no_cause(void **state)
{
	char message[PUBLISH_MESSAGE_BYTES];

	(void)state;
	CHECK(setenv("JOURNAL_STREAM", "8:12345", 1) == 0);
	run("echo \"${JOURNAL_STREAM:+<3>}${JOURNAL_STREAM:-error: }pipeline: a slip\"; echo an end",
	    message);
	unsetenv("JOURNAL_STREAM");
	CHECK(strcmp(message, "error: pipeline: a slip") == 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(the_cause_is_the_last_error, start, stop),
		cmocka_unit_test_setup_teardown(a_cause_of_any_bytes_can_be_kept, start, stop),
		cmocka_unit_test_setup_teardown(a_service_hides_no_cause, start, stop),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
