/* What a browser asks to be saved; tests/fuzz/fuzz_curator_request.c has all other messages. */
#include "curator/session/request.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "tests/check.h"

static int parse(struct request *out, const char *text)
{
	char problem[REQUEST_PROBLEM_BYTES];

	return request_parse(out, text, strlen(text), problem);
}

static void a_save_says_what_it_is_to_replace(void **state)
{
	struct request request;

	(void)state;
	CHECK(parse(&request, "{\"type\": \"save\", \"id\": \"gate\"}") == 0);
	CHECK(!request.is_new && !request.replaces && !*request.title && !*request.from);
	CHECK(parse(&request, "{\"type\": \"save\", \"id\": \"gate\", \"title\": \"The gate\", "
			      "\"from\": \"Gate\", \"new\": true, \"replace\": true}") == 0);
	CHECK(request.is_new && request.replaces && strcmp(request.title, "The gate") == 0 &&
	      strcmp(request.from, "Gate") == 0);
	CHECK(parse(&request, "{\"type\": \"save\", \"id\": \"gate\", \"new\": 1}") == -EINVAL);
	CHECK(parse(&request, "{\"type\": \"save\", \"id\": \"gate\", \"from\": 1}") == -EINVAL);
}

/* As many as the pages let one write, each of four bytes. */
static void a_title_may_have_200_characters(void **state)
{
	char title[4 * 201 + 1] = "", text[1000];
	struct request request;

	(void)state;
	for (int n = 0; n < 200; n++)
		memcpy(title + 4 * n, "\xf0\x91\x84\x80", 5);
	snprintf(text, sizeof(text), "{\"type\": \"save\", \"id\": \"gate\", \"title\": \"%s\"}",
		 title);
	CHECK(parse(&request, text) == 0 && strcmp(request.title, title) == 0);
	title[800] = 'x';
	snprintf(text, sizeof(text), "{\"type\": \"save\", \"id\": \"gate\", \"title\": \"%s\"}",
		 title);
	CHECK(parse(&request, text) == -EINVAL);
}

static void an_error_can_name_what_it_answers(void **state)
{
	(void)state;
	CHECK(strcmp(request_type(REQUEST_CAMERA), "camera") == 0);
	CHECK(strcmp(request_type(REQUEST_OPEN), "open") == 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_save_says_what_it_is_to_replace),
		cmocka_unit_test(a_title_may_have_200_characters),
		cmocka_unit_test(an_error_can_name_what_it_answers),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
