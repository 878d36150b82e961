#include "net/asked_file.h"

#include "tests/check.h"
#include "tests/net/fake_http.h"

struct stage {
	struct link link;
	struct asked_file *asked;
	int answers;
	struct message_file answer;
	char text[64];
};

static void on_answer(void *data, const struct message_file *file)
{
	struct stage *stage = data;

	stage->answers++;
	stage->answer = *file;
	snprintf(stage->text, sizeof(stage->text), "%.*s", (int)file->bytes.size,
		 (const char *)file->bytes.data);
}

static int set_up(void **state)
{
	struct stage *stage = calloc(1, sizeof(*stage));
	const struct asked_file_options options = { .link = &stage->link,
						    .answered = on_answer,
						    .data = stage };

	*state = stage;
	memset(&server, 0, sizeof(server));
	server.now_ms = 1000;
	link_init(&stage->link);
	CHECK(asked_file_create(&stage->asked, &options) == 0);
	return 0;
}

static int tear_down(void **state)
{
	struct stage *stage = *state;

	asked_file_destroy(stage->asked);
	CHECK(stage->link.in_flight == 0);
	free(stage);
	return 0;
}

static void want(struct stage *stage, const char *name)
{
	struct message_file file = { .bytes_max = 16 };

	snprintf(file.name, sizeof(file.name), "%s", name);
	asked_file_want(stage->asked, &file);
	asked_file_work(stage->asked);
}

static void reply(const char *text, int rc)
{
	if (text[0])
		give(asked(0), (struct bytes){ (const uint8_t *)text, strlen(text) });
	end(asked(0), rc);
}

static void brings_what_is_asked_for(void **state)
{
	struct stage *stage = *state;

	CHECK(asked_file_due_ms(stage->asked) == INT64_MAX);
	want(stage, "2.root.json");
	CHECK(strcmp(asked(0)->path, "tuf/2.root.json") == 0 && asked(0)->get.ceiling == 16);
	reply("sandstone", 0);
	CHECK(stage->answers == 1 && stage->answer.answer == FILE_IS_HERE);
	CHECK(strcmp(stage->answer.name, "2.root.json") == 0 &&
	      strcmp(stage->text, "sandstone") == 0);
	want(stage, "2.root.json"); /* once more, since it was answered */
	reply("", -ENOENT);
	CHECK(server.count == 2 && stage->answers == 2 && stage->answer.answer == FILE_NOT_THERE);
	want(stage, "3.root.json");
	reply("", -EBADMSG); /* larger than the ceiling, by its own account */
	CHECK(stage->answer.answer == FILE_TOO_LARGE && stage->answer.bytes.size == 0);
	want(stage, "3.root.json");
	reply("", 0); /* an empty file is none */
	CHECK(stage->answer.answer == FILE_NOT_THERE);
}

static void asks_again_until_the_server_answers(void **state)
{
	struct stage *stage = *state;

	want(stage, "2.root.json");
	reply("half", -EHOSTUNREACH);
	CHECK(stage->answers == 0);
	asked_file_work(stage->asked);
	CHECK(server.count == 1 && asked_file_due_ms(stage->asked) > server.now_ms);
	server.now_ms += 60000;
	asked_file_work(stage->asked);
	CHECK(server.count == 2);
	reply("whole", 0);
	CHECK(stage->answers == 1 && strcmp(stage->text, "whole") == 0);
}

static void another_file_ends_the_request_and_the_same_does_not(void **state)
{
	struct stage *stage = *state;

	want(stage, "2.root.json");
	want(stage, "2.root.json");
	CHECK(server.count == 1 && server.cancelled == 0);
	want(stage, "1.snapshot.json");
	CHECK(server.count == 2 && server.cancelled == 1);
	reply("S", 0);
	CHECK(stage->answers == 1 && strcmp(stage->answer.name, "1.snapshot.json") == 0);
	want(stage, "1.targets.json");
	asked_file_drop(stage->asked);
	asked_file_work(stage->asked);
	CHECK(server.count == 3 && server.cancelled == 2 && stage->answers == 1);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(brings_what_is_asked_for, set_up, tear_down),
		cmocka_unit_test_setup_teardown(asks_again_until_the_server_answers, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(another_file_ends_the_request_and_the_same_does_not,
						set_up, tear_down),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
