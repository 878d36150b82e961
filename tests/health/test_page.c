#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "health/page.h"
#include "tests/health/snapshots.h"

static struct snapshot snapshot;
static struct verdict verdict;
static struct buffer out;

static int begin(void **state)
{
	(void)state;
	make_well(&snapshot);
	buffer_init(&out, PAGE_BYTES_MAX);
	return 0;
}

static int end(void **state)
{
	(void)state;
	snapshot_finish(&snapshot);
	buffer_finish(&out);
	return 0;
}

/* The answer, terminated; *body is where its body begins. */
static const char *ask(enum request_page page, bool head, const char **body)
{
	const struct request request = { page, head };
	unsigned long size;
	const char *length;

	verdict_judge(&verdict, &snapshot);
	page_answer(&out, &request, &snapshot, &verdict);
	buffer_put_u8(&out, '\0');
	CHECK(out.error == 0);
	*body = strstr((char *)out.data, "\r\n\r\n");
	CHECK(*body);
	*body += 4;
	length = strstr((char *)out.data, "Content-Length: ");
	CHECK(length);
	size = strtoul(length + 16, NULL, 10);
	CHECK(strlen(*body) == (head ? 0 : size) && size > 0);
	return (char *)out.data;
}

static bool begins(const char *text, const char *with)
{
	return strncmp(text, with, strlen(with)) == 0;
}

static void health_is_one_word_and_a_status(void **state)
{
	const char *body;

	(void)state;
	CHECK(begins(ask(REQUEST_HEALTH, false, &body), "HTTP/1.1 200 OK\r\n"));
	CHECK(strcmp(body, "well\n") == 0);
	snapshot.machine.temperature_c = 85;
	CHECK(begins(ask(REQUEST_HEALTH, false, &body), "HTTP/1.1 200 OK\r\n"));
	CHECK(strcmp(body, "remark\nremark: The computer is too hot: 85 degrees Celsius.\n") == 0);
	snapshot.machine.temperature_c = 99;
	CHECK(begins(ask(REQUEST_HEALTH, false, &body), "HTTP/1.1 503 Service Unavailable\r\n"));
	CHECK(begins(body, "ill\nill: "));
	CHECK(begins(ask(REQUEST_HEALTH, true, &body), "HTTP/1.1 503 "));
}

static void metrics_are_the_programs_own_and_the_machines(void **state)
{
	const char *body;
	double value = -1;
	struct bytes text;

	(void)state;
	CHECK(strstr(ask(REQUEST_METRICS, false, &body),
		     "Content-Type: text/plain; version=0.0.4; charset=utf-8\r\n"));
	text = (struct bytes){ (const uint8_t *)body, strlen(body) };
	CHECK(metrics_valid(text, "gopura_"));
	CHECK(begins(body, WELL_KIOSK WELL_FETCH));
	CHECK(metrics_find(text, "gopura_kiosk_up", &value) && value == 1);
	CHECK(metrics_find(text, "gopura_terminal_level", &value) && value == 0);
	CHECK(metrics_find(text, "gopura_terminal_temperature_celsius", &value) && value == 55);
	CHECK(metrics_find(text, "gopura_terminal_written_bytes_total", &value) && value == 3e9);
}

static void what_is_not_known_is_not_told(void **state)
{
	const char *body;
	double value = -1;
	struct bytes text;

	(void)state;
	snapshot.machine.temperature_c = NAN;
	snapshot.machine.written_bytes = NAN;
	snapshot.answers[PROGRAM_KIOSK].rc = -ETIMEDOUT;
	buffer_clear(&snapshot.answers[PROGRAM_KIOSK].text);
	ask(REQUEST_METRICS, false, &body);
	text = (struct bytes){ (const uint8_t *)body, strlen(body) };
	CHECK(metrics_valid(text, "gopura_"));
	CHECK(metrics_find(text, "gopura_kiosk_up", &value) && value == 0);
	CHECK(metrics_find(text, "gopura_terminal_level", &value) && value == 2);
	CHECK(!strstr(body, "temperature") && !strstr(body, "nan"));
	ask(REQUEST_OVERVIEW, false, &body);
	CHECK(!strstr(body, "nan") && !strstr(body, "Temperature"));
	CHECK(strstr(body, "it hangs"));
}

static void the_page_says_what_is_ill_and_escapes_what_others_wrote(void **state)
{
	const char *body;

	(void)state;
	CHECK(strstr(ask(REQUEST_OVERVIEW, false, &body),
		     "Content-Type: text/html; charset=utf-8"));
	CHECK(strstr(body, "All is well") && strstr(body, "http-equiv=refresh"));
	CHECK(strstr(body, "Prasat &#60;b&#62;, number 7") && strstr(body, "terminal-&#60;3&#62;"));
	CHECK(strstr(body, "V3D 7.1") && strstr(body, "slot A"));
	CHECK(!strstr(body, "<b>") && !strstr(body, "<script"));
	change(&snapshot, PROGRAM_KIOSK, "gopura_kiosk_touch", "gopura_kiosk_touch_devices 0");
	change(&snapshot, PROGRAM_FETCH, "gopura_fetch_requests",
	       "gopura_fetch_requests_total 9\ngopura_fetch_refused_at_seconds 1699999400\n"
	       "gopura_fetch_refusal_info{what=\"<x>\",why=\"too slow\"} 1");
	snprintf(snapshot.machine.faults, sizeof(snapshot.machine.faults), "line 3: '\"<&>\"'");
	ask(REQUEST_OVERVIEW, false, &body);
	CHECK(strstr(body, "It is ill") && strstr(body, "No finger is felt"));
	CHECK(strstr(body, "&#60;x&#62;, 10 minutes ago: too slow"));
	CHECK(strstr(body, "line 3: &#39;&#34;&#60;&#38;&#62;&#34;&#39;"));
}

static void a_page_of_the_longest_texts_fits(void **state)
{
	struct buffer *text = &snapshot.answers[PROGRAM_KIOSK].text;
	const char *body;

	(void)state;
	buffer_clear(text);
	buffer_put(text, "gopura_kiosk_release_info{root=\"", 32);
	while (text->size < METRICS_BYTES_MAX / 2)
		buffer_put_u8(text, '<');
	buffer_put(text, "\",name=\"", 8);
	while (text->size < METRICS_BYTES_MAX - 5)
		buffer_put_u8(text, '<');
	buffer_put(text, "\"} 1\n", 5);
	CHECK(metrics_valid(buffer_bytes(text), "gopura_kiosk_"));
	memset(snapshot.machine.faults, '<', sizeof(snapshot.machine.faults) - 1);
	for (size_t i = 0; i + 1 < sizeof(snapshot.machine.faults); i += 100)
		snapshot.machine.faults[i] = '\n';
	ask(REQUEST_OVERVIEW, false, &body);
	ask(REQUEST_METRICS, false, &body);
}

static void refusals_name_their_status(void **state)
{
	(void)state;
	page_refuse(&out, 405);
	buffer_put_u8(&out, '\0');
	CHECK(begins((char *)out.data, "HTTP/1.1 405 Method Not Allowed\r\n"));
	CHECK(strstr((char *)out.data, "\r\nAllow: GET, HEAD\r\n"));
	CHECK(strstr((char *)out.data, "\r\n\r\n405 Method Not Allowed\n"));
	page_refuse(&out, 404);
	buffer_put_u8(&out, '\0');
	CHECK(begins((char *)out.data, "HTTP/1.1 404 Not Found\r\n"));
	CHECK(!strstr((char *)out.data, "Allow:"));
}

#define CASE(name) cmocka_unit_test_setup_teardown(name, begin, end)

int main(void)
{
	const struct CMUnitTest tests[] = {
		CASE(health_is_one_word_and_a_status),
		CASE(metrics_are_the_programs_own_and_the_machines),
		CASE(what_is_not_known_is_not_told),
		CASE(the_page_says_what_is_ill_and_escapes_what_others_wrote),
		CASE(a_page_of_the_longest_texts_fits),
		CASE(refusals_name_their_status),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
