#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "health/web_page.h"
#include "tests/health/snapshots.h"

static struct snapshot snapshot;
static struct verdict verdict;
static struct buffer out;
static const char *type;
static int status;

static int begin(void **state)
{
	(void)state;
	make_well(&snapshot);
	buffer_init(&out, WEB_PAGE_BYTES_MAX + 1);
	return 0;
}

static int end(void **state)
{
	(void)state;
	snapshot_finish(&snapshot);
	buffer_finish(&out);
	return 0;
}

/* The body of a page, terminated, and its status and type. */
static const char *body_of(enum web_page page)
{
	verdict_judge(&verdict, &snapshot);
	buffer_clear(&out);
	status = web_page_write(&out, &type, page, &snapshot, &verdict);
	buffer_put_u8(&out, '\0');
	CHECK(out.error == 0 && out.size > 1);
	return (char *)out.data;
}

static bool begins(const char *text, const char *with)
{
	return strncmp(text, with, strlen(with)) == 0;
}

static void a_path_names_its_page(void **state)
{
	(void)state;
	CHECK(web_page_of_path("/") == WEB_PAGE_OVERVIEW &&
	      web_page_of_path("/metrics") == WEB_PAGE_METRICS);
	CHECK(web_page_of_path("/health") == WEB_PAGE_HEALTH &&
	      web_page_of_path("/visits.csv") == WEB_PAGE_VISITS);
	CHECK(web_page_of_path("") == WEB_PAGE_NONE &&
	      web_page_of_path("/health/") == WEB_PAGE_NONE);
	CHECK(web_page_of_path("/../visits.csv") == WEB_PAGE_NONE &&
	      web_page_of_path("metrics") == WEB_PAGE_NONE);
}

static void health_is_one_word_and_a_status(void **state)
{
	(void)state;
	CHECK(strcmp(body_of(WEB_PAGE_HEALTH), "ok\n") == 0 && status == 200);
	CHECK(strcmp(type, "text/plain") == 0);
	snapshot.machine.temperature_c = 85;
	CHECK(strcmp(body_of(WEB_PAGE_HEALTH),
		     "warning\nwarning: The computer is too hot: 85 °C.\n") == 0);
	CHECK(status == 200);
	snapshot.machine.temperature_c = 99;
	CHECK(begins(body_of(WEB_PAGE_HEALTH), "critical\ncritical: ") && status == 503);
}

static void metrics_are_the_programs_own_and_the_machines(void **state)
{
	const char *body = body_of(WEB_PAGE_METRICS);
	double value = -1;
	struct bytes text;

	(void)state;
	CHECK(status == 200 && strcmp(type, "text/plain; version=0.0.4") == 0);
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
	body = body_of(WEB_PAGE_METRICS);
	text = (struct bytes){ (const uint8_t *)body, strlen(body) };
	CHECK(metrics_valid(text, "gopura_"));
	CHECK(metrics_find(text, "gopura_kiosk_up", &value) && value == 0);
	CHECK(metrics_find(text, "gopura_terminal_level", &value) && value == 2);
	CHECK(!strstr(body, "temperature") && !strstr(body, "nan"));
	body = body_of(WEB_PAGE_OVERVIEW);
	CHECK(!strstr(body, "nan") && !strstr(body, "Temperature"));
	CHECK(strstr(body, "it hangs"));
}

static void the_page_says_what_is_wrong_and_escapes_what_others_wrote(void **state)
{
	const char *body = body_of(WEB_PAGE_OVERVIEW);

	(void)state;
	CHECK(status == 200 && strcmp(type, "text/html") == 0);
	CHECK(strstr(body, "Everything works") && strstr(body, "http-equiv=refresh"));
	CHECK(strstr(body, "Prasat &#60;b&#62;, version 7") &&
	      strstr(body, "terminal-&#60;3&#62;"));
	CHECK(strstr(body, "V3D 7.1") && strstr(body, "slot A"));
	CHECK(!strstr(body, "<b>") && !strstr(body, "<script"));
	change(&snapshot, PROGRAM_KIOSK, "gopura_kiosk_touch", "gopura_kiosk_touch_devices 0");
	change(&snapshot, PROGRAM_FETCH, "gopura_fetch_requests",
	       "gopura_fetch_requests_total 9\ngopura_fetch_refused_at_seconds 1699999400\n"
	       "gopura_fetch_refusal_info{what=\"<x>\",why=\"too slow\"} 1");
	snprintf(snapshot.machine.faults, sizeof(snapshot.machine.faults), "line 3: '\"<&>\"'");
	body = body_of(WEB_PAGE_OVERVIEW);
	CHECK(strstr(body, "Needs attention") && strstr(body, "The touchscreen does not work"));
	CHECK(strstr(body, "&#60;x&#62;, 10 minutes ago: too slow"));
	CHECK(strstr(body, "line 3: &#39;&#34;&#60;&#38;&#62;&#34;&#39;"));
}

static void the_page_says_when_what_is_signed_expires(void **state)
{
	const char *const timestamp = "gopura_kiosk_trust_timestamp_expires_at_seconds";

	(void)state;
	CHECK(strstr(body_of(WEB_PAGE_OVERVIEW),
		     "<th scope=row>Signatures<td>root 2, expires in 2314 days; timestamp 23 days; "
		     "release 1157 days<"));
	change(&snapshot, PROGRAM_KIOSK, "gopura_kiosk_trust_root_version",
	       "gopura_kiosk_trust_root_version 3\ngopura_kiosk_trust_tuf 1");
	change(&snapshot, PROGRAM_KIOSK, timestamp,
	       "gopura_kiosk_trust_timestamp_expires_at_seconds 1699000000");
	change(&snapshot, PROGRAM_KIOSK, "gopura_kiosk_trust_release", ""); /* not known */
	CHECK(strstr(
		body_of(WEB_PAGE_OVERVIEW),
		"root 3 of The Update Framework, expires in 2314 days; timestamp 11 days ago<"));
	change(&snapshot, PROGRAM_KIOSK, "gopura_kiosk_trust_root_version", ""); /* no root */
	CHECK(!strstr(body_of(WEB_PAGE_OVERVIEW), "Signatures"));
}

static void a_page_of_the_longest_texts_fits(void **state)
{
	struct buffer *text = &snapshot.answers[PROGRAM_KIOSK].text;

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
	body_of(WEB_PAGE_OVERVIEW);
	body_of(WEB_PAGE_METRICS);
}

#define CASE(name) cmocka_unit_test_setup_teardown(name, begin, end)

int main(void)
{
	const struct CMUnitTest tests[] = {
		CASE(a_path_names_its_page),
		CASE(health_is_one_word_and_a_status),
		CASE(metrics_are_the_programs_own_and_the_machines),
		CASE(what_is_not_known_is_not_told),
		CASE(the_page_says_what_is_wrong_and_escapes_what_others_wrote),
		CASE(the_page_says_when_what_is_signed_expires),
		CASE(a_page_of_the_longest_texts_fits),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
