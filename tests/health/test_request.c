#include <stdlib.h>
#include <string.h>

#include "health/request.h"
#include "tests/check.h"

static int parse(struct request *request, const char *text)
{
	char *exact = malloc(strlen(text)); /* no slack for ASan */
	int status;

	memcpy(exact, text, strlen(text));
	status = request_parse(request, (struct bytes){ (uint8_t *)exact, strlen(text) });
	free(exact);
	return status;
}

static void three_pages_answer_to_get_and_head(void **state)
{
	struct request r;

	(void)state;
	CHECK(parse(&r, "GET / HTTP/1.1\r\n\r\n") == 200);
	CHECK(r.page == REQUEST_OVERVIEW && !r.head);
	CHECK(parse(&r, "GET /metrics HTTP/1.1\r\nHost: x\r\nAccept:\r\n\r\n") == 200);
	CHECK(r.page == REQUEST_METRICS);
	CHECK(parse(&r, "HEAD /health?verbose=1 HTTP/1.0\r\nA-b_c: \td\r\n\r\nmore") == 200);
	CHECK(r.page == REQUEST_HEALTH && r.head);
	CHECK(parse(&r, "GET /visits.csv HTTP/1.1\r\n\r\n") == 200);
	CHECK(r.page == REQUEST_VISITS && !r.head);
}

static void what_is_wrong_gets_its_status(void **state)
{
	static const struct {
		const char *text;
		int status;
	} wrong[] = {
		{ "GET /etc/passwd HTTP/1.1\r\n\r\n", 404 },
		{ "GET /../metrics HTTP/1.1\r\n\r\n", 404 },
		{ "GET /visits HTTP/1.1\r\n\r\n", 404 },
		{ "GET /metrics/ HTTP/1.1\r\n\r\n", 404 },
		{ "GET //metrics HTTP/1.1\r\n\r\n", 404 },
		{ "GET /%6detrics HTTP/1.1\r\n\r\n", 404 },
		{ "GET /metric HTTP/1.1\r\n\r\n", 404 },
		{ "POST / HTTP/1.1\r\nContent-Length: 1\r\n\r\nx", 405 },
		{ "DELETE /nothing HTTP/1.1\r\n\r\n", 405 },
		{ "get / HTTP/1.1\r\n\r\n", 405 },
		{ "GET / HTTP/2.0\r\n\r\n", 505 },
		{ "GET / HTTP/1.2\r\n\r\n", 505 },
		{ "GET / http/1.1\r\n\r\n", 400 },
		{ "GET / HTTP/1.1 \r\n\r\n", 400 },
		{ "GET  / HTTP/1.1\r\n\r\n", 400 },
		{ " GET / HTTP/1.1\r\n\r\n", 400 },
		{ "GET /\r\n\r\n", 400 },
		{ "GET http://x/ HTTP/1.1\r\n\r\n", 400 },
		{ "GET * HTTP/1.1\r\n\r\n", 400 },
		{ "G\x01T / HTTP/1.1\r\n\r\n", 400 },
		{ "G(T / HTTP/1.1\r\n\r\n", 400 },
		{ "GET /\x7f HTTP/1.1\r\n\r\n", 400 },
		{ "GET / HTTP/1.1\r\nno colon\r\n\r\n", 400 },
		{ "GET / HTTP/1.1\r\nbad name: x\r\n\r\n", 400 },
		{ "GET / HTTP/1.1\r\n folded: x\r\n\r\n", 400 },
		{ "GET / HTTP/1.1\r\n: x\r\n\r\n", 400 },
		{ "GET / HTTP/1.1\r\na: b\nc: d\r\n\r\n", 400 },
		{ "GET /nothing HTTP/1.1\r\nno colon\r\n\r\n", 400 },
		{ "\r\n\r\n", 400 },
	};

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(wrong); i++) {
		struct request request;
		const int status = parse(&request, wrong[i].text);

		if (status != wrong[i].status)
			fail_msg("%d and not %d: %s", status, wrong[i].status, wrong[i].text);
	}
}

static void a_head_is_waited_for_until_it_is_too_long(void **state)
{
	const char *whole = "GET /health HTTP/1.1\r\nHost: x\r\n\r\n";
	const char *beginning = "GET / HTTP/1.1\r\nA: ";
	static char text[REQUEST_BYTES_MAX + 64];
	struct request request;

	(void)state;
	for (size_t n = 0; n < strlen(whole); n++) {
		char *cut = strndup(whole, n);

		CHECK(parse(&request, cut) == 0);
		free(cut);
	}
	memset(text, 'a', sizeof(text));
	memcpy(text, beginning, strlen(beginning));
	CHECK(request_parse(&request, (struct bytes){ (uint8_t *)text, REQUEST_BYTES_MAX - 1 }) ==
	      0);
	CHECK(request_parse(&request, (struct bytes){ (uint8_t *)text, REQUEST_BYTES_MAX }) == 431);
	memcpy(text + sizeof(text) - 4, "\r\n\r\n", 4);
	CHECK(request_parse(&request, (struct bytes){ (uint8_t *)text, sizeof(text) }) == 431);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(three_pages_answer_to_get_and_head),
		cmocka_unit_test(what_is_wrong_gets_its_status),
		cmocka_unit_test(a_head_is_waited_for_until_it_is_too_long),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
