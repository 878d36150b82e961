#include "curator/publish/publish_files.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/curator/publish/publish_folder.h"

static void files_that_are_not_there_are_empty(void **state)
{
	struct publish_request request;
	struct publish_state now;
	struct publish_releases releases;

	(void)state;
	CHECK(publish_request_read(&request, folder) == 0 && request.number == 0);
	CHECK(publish_state_read(&now, folder) == 0 && now.step == PUBLISH_IDLE);
	CHECK(publish_releases_read(&releases, folder) == 0 && releases.count == 0);
	CHECK(!publish_is_pending(&request, &now));
}

static void what_is_written_is_read_again(void **state)
{
	struct publish_state written = { .request = { 7, 3, 1700000000, "petra",
						      "new \"pages\" of \xe1\x9e\x80" },
					 .step = PUBLISH_FAILED,
					 .begun_s = 1700000001,
					 .ended_s = 1700000002,
					 .before = 11,
					 .after = 12,
					 .message = "error: parts.json:3: is wrong" };
	struct publish_request request;
	struct publish_state now;

	(void)state;
	CHECK(publish_request_write(&written.request, folder) == 0);
	CHECK(publish_request_read(&request, folder) == 0);
	CHECK(request.number == 7 && request.sequence == 3 && request.at_s == 1700000000);
	CHECK(strcmp(request.by, "petra") == 0);
	CHECK(strcmp(request.comment, written.request.comment) == 0);
	CHECK(publish_state_write(&written, folder) == 0 && publish_state_read(&now, folder) == 0);
	CHECK(now.step == PUBLISH_FAILED && now.before == 11 && now.after == 12);
	CHECK(now.ended_s == 1700000002 && strcmp(now.message, written.message) == 0);
}

static void a_request_is_pending_until_its_end_is_known(void **state)
{
	const struct publish_request asked = { .number = 5 };
	struct publish_state now = { .request = { .number = 4 }, .step = PUBLISH_DONE };

	(void)state;
	CHECK(publish_is_pending(&asked, &now));
	now.request.number = 5;
	now.step = PUBLISH_RUNNING;
	CHECK(publish_is_pending(&asked, &now));
	now.step = PUBLISH_FAILED;
	CHECK(!publish_is_pending(&asked, &now));
}

static void releases_keep_their_order(void **state)
{
	struct publish_release rows[] = { { 2, "aa", "second", "petra", 5 },
					  { 1, "bb", "", "", 0 } };
	const struct publish_releases written = { rows, 2, 2 };
	struct publish_releases releases;

	(void)state;
	CHECK(publish_releases_write(&written, folder) == 0);
	CHECK(publish_releases_read(&releases, folder) == 0 && releases.count == 2);
	CHECK(releases.list[0].sequence == 2 && strcmp(releases.list[1].root, "bb") == 0);
	CHECK(strcmp(releases.list[0].by, "petra") == 0 && releases.list[0].at_s == 5);
	publish_releases_finish(&releases);
}

#define REQUEST(members) "{" members ", \"at\": 1, \"by\": \"a\", \"comment\": \"\"}"

static void refuses_what_no_web_process_writes(void **state)
{
	static const char *const bad[] = {
		"",
		"[]",
		"{}",
		REQUEST("\"number\": -1, \"sequence\": 0"),
		REQUEST("\"number\": 1.5, \"sequence\": 0"),
		REQUEST("\"number\": 1e300, \"sequence\": 0"),
		REQUEST("\"number\": \"1\", \"sequence\": 0"),
		"{\"number\": 1, \"sequence\": 0, \"at\": 1, \"by\": \"a b\", \"comment\": \"\"}",
		"{\"number\": 1, \"sequence\": 0, \"at\": 1, \"by\": \"a\", \"comment\": \"a\\nb\"}",
		"{\"number\": 1, \"sequence\": 0, \"at\": 1, \"by\": \"a\", \"comment\": 5}",
	};

	(void)state;
	for (unsigned n = 0; n < ARRAY_COUNT(bad); n++) {
		struct publish_request request;

		CHECK(publish_request_parse(&request, (struct bytes){ (const uint8_t *)bad[n],
								      strlen(bad[n]) }) ==
		      -EBADMSG);
		CHECK(request.number == 0);
	}
}

static void a_comment_is_one_line_that_fits(void **state)
{
	char comment[PUBLISH_COMMENT_BYTES + 1];

	(void)state;
	CHECK(publish_comment_is_valid("") && publish_comment_is_valid("--out /etc"));
	CHECK(!publish_comment_is_valid("two\nlines") && !publish_comment_is_valid("\xff"));
	memset(comment, 'a', sizeof(comment));
	comment[PUBLISH_COMMENT_BYTES] = '\0';
	CHECK(!publish_comment_is_valid(comment));
	comment[PUBLISH_COMMENT_BYTES - 1] = '\0';
	CHECK(publish_comment_is_valid(comment));
}

static void there_is_one_publisher_and_others_see_it(void **state)
{
	int lock;

	(void)state;
	CHECK(!publish_has_publisher(folder));
	lock = publish_lock(folder);
	CHECK(lock >= 0 && publish_has_publisher(folder));
	CHECK(publish_lock(folder) == -EBUSY);
	close(lock);
	CHECK(!publish_has_publisher(folder));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(files_that_are_not_there_are_empty, start, stop),
		cmocka_unit_test_setup_teardown(what_is_written_is_read_again, start, stop),
		cmocka_unit_test(a_request_is_pending_until_its_end_is_known),
		cmocka_unit_test_setup_teardown(releases_keep_their_order, start, stop),
		cmocka_unit_test(refuses_what_no_web_process_writes),
		cmocka_unit_test(a_comment_is_one_line_that_fits),
		cmocka_unit_test_setup_teardown(there_is_one_publisher_and_others_see_it, start,
						stop),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
