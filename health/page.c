/* Builds the HTTP answers of gopura-health: heads, the body of each page but the file of visits,
 * and refusals. */
#include "health/page.h"

#include <math.h>

#include "health/overview.h"
#include "health/text.h"

static const char *const level_words[LEVEL_COUNT] = { "well", "remark", "ill" };

static const char *reason(int status)
{
	switch (status) {
	case 200:
		return "OK";
	case 400:
		return "Bad Request";
	case 404:
		return "Not Found";
	case 405:
		return "Method Not Allowed";
	case 431:
		return "Request Header Fields Too Large";
	case 503:
		return "Service Unavailable";
	default:
		return "HTTP Version Not Supported";
	}
}

static void put_head(struct buffer *out, int status, const char *type, uint64_t body_bytes)
{
	text_format(
		out,
		"HTTP/1.1 %d %s\r\nContent-Type: %s; charset=utf-8\r\nContent-Length: %llu\r\n"
		"Connection: close\r\nCache-Control: no-store\r\n"
		"X-Content-Type-Options: nosniff\r\n"
		"Content-Security-Policy: default-src 'none'; style-src 'unsafe-inline'\r\n%s\r\n",
		status, reason(status), type, (unsigned long long)body_bytes,
		status == 405 ? "Allow: GET, HEAD\r\n" : "");
}

/* ---- /health */

static int write_word(struct buffer *out, const struct verdict *verdict)
{
	text_format(out, "%s\n", level_words[verdict->level]);
	for (size_t i = 0; i < verdict->count; i++)
		text_format(out, "%s: %s%s%s\n", level_words[verdict->findings[i].level],
			    verdict->findings[i].what, verdict->findings[i].detail[0] ? ": " : "",
			    verdict->findings[i].detail);
	return verdict->level == LEVEL_ILL ? 503 : 200;
}

/* ---- /metrics */

static void gauge(struct buffer *out, const char *name, const char *help, double value)
{
	if (!isnan(value))
		metrics_gauge(out, name, help, value);
}

static void write_metrics(struct buffer *out, const struct snapshot *snapshot,
			  const struct verdict *verdict)
{
	const struct machine *m = &snapshot->machine;

	for (int i = 0; i < PROGRAM_COUNT; i++)
		buffer_put(out, snapshot->answers[i].text.data, snapshot->answers[i].text.size);
	gauge(out, "gopura_kiosk_up", "Whether the kiosk answers.",
	      snapshot->answers[PROGRAM_KIOSK].rc == 0);
	gauge(out, "gopura_fetch_up", "Whether the fetcher answers.",
	      snapshot->answers[PROGRAM_FETCH].rc == 0);
	gauge(out, "gopura_terminal_level", "0 well, 1 works with a remark, 2 ill.",
	      verdict->level);
	gauge(out, "gopura_terminal_findings", "Remarks and ills.", (double)verdict->count);
	gauge(out, "gopura_terminal_uptime_seconds", "Since the machine began.", m->uptime_s);
	gauge(out, "gopura_terminal_temperature_celsius", "Of the hottest zone.", m->temperature_c);
	gauge(out, "gopura_terminal_memory_bytes", "Of the machine.", m->memory_bytes);
	gauge(out, "gopura_terminal_memory_free_bytes", "That programs could still take.",
	      m->memory_free_bytes);
	gauge(out, "gopura_terminal_data_bytes", "Of the data partition.", m->data_bytes);
	gauge(out, "gopura_terminal_data_free_bytes", "Of them, free.", m->data_free_bytes);
	if (!isnan(m->written_bytes))
		metrics_counter(out, "gopura_terminal_written_bytes_total",
				"To all disks since the machine began.", m->written_bytes);
	metrics_info(out, "gopura_terminal_info", "Name, and the firmware's slot.",
		     (const struct figure_label[]){ { "name", m->name }, { "slot", m->slot } }, 2);
}

/* ---- whole answers */

static void answer(struct buffer *out, int status, const char *type, const struct buffer *body,
		   bool head)
{
	buffer_clear(out);
	put_head(out, status, type, body->size);
	if (!head)
		buffer_put(out, body->data, body->size);
}

void page_answer(struct buffer *out, const struct request *request, const struct snapshot *snapshot,
		 const struct verdict *verdict)
{
	const char *type = "text/plain";
	struct buffer body;
	int status = 200;

	buffer_init(&body, PAGE_BYTES_MAX - REQUEST_BYTES_MAX);
	switch (request->page) {
	case REQUEST_OVERVIEW:
		type = "text/html";
		overview_write(&body, snapshot, verdict);
		break;
	case REQUEST_METRICS:
		type = "text/plain; version=0.0.4";
		write_metrics(&body, snapshot, verdict);
		break;
	case REQUEST_HEALTH:
		status = write_word(&body, verdict);
		break;
	case REQUEST_VISITS:
		status = 404;
		break;
	}
	answer(out, status, type, &body, request->head);
	buffer_finish(&body);
}

void page_visits_head(struct buffer *out, uint64_t file_bytes)
{
	put_head(out, 200, "text/csv", file_bytes);
}

void page_refuse(struct buffer *out, int status)
{
	struct buffer body;

	buffer_init(&body, REQUEST_BYTES_MAX);
	text_format(&body, "%d %s\n", status, reason(status));
	answer(out, status, "text/plain", &body, false);
	buffer_finish(&body);
}
