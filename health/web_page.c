/* Writes the body of each page but the file of visits. */
#include "health/web_page.h"

#include <math.h>
#include <string.h>

#include "health/overview.h"

static const char *const level_names[LEVEL_COUNT] = { "ok", "warning", "critical" };

enum web_page web_page_of_path(const char *path)
{
	static const struct {
		const char *path;
		enum web_page page;
	} pages[] = {
		{ "/", WEB_PAGE_OVERVIEW },
		{ "/metrics", WEB_PAGE_METRICS },
		{ "/health", WEB_PAGE_HEALTH },
		{ "/visits.csv", WEB_PAGE_VISITS },
	};

	for (size_t i = 0; i < ARRAY_COUNT(pages); i++)
		if (strcmp(path, pages[i].path) == 0)
			return pages[i].page;
	return WEB_PAGE_NONE;
}

/* ---- /health */

static int write_health(struct buffer *out, const struct verdict *verdict)
{
	buffer_print(out, "%s\n", level_names[verdict->level]);
	for (size_t i = 0; i < verdict->count; i++)
		buffer_print(out, "%s: %s%s%s\n", level_names[verdict->findings[i].level],
			     verdict->findings[i].what, verdict->findings[i].detail[0] ? ": " : "",
			     verdict->findings[i].detail);
	return verdict->level == LEVEL_CRITICAL ? 503 : 200;
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
	gauge(out, "gopura_kiosk_up", "1 if gopura-kiosk responds, else 0.",
	      snapshot->answers[PROGRAM_KIOSK].rc == 0);
	gauge(out, "gopura_fetch_up", "1 if gopura-fetch responds, else 0.",
	      snapshot->answers[PROGRAM_FETCH].rc == 0);
	gauge(out, "gopura_terminal_level", "State of the terminal: 0 ok, 1 warning, 2 critical.",
	      verdict->level);
	gauge(out, "gopura_terminal_findings", "Number of warnings and critical findings.",
	      (double)verdict->count);
	gauge(out, "gopura_terminal_uptime_seconds", "Time since the computer started.",
	      m->uptime_s);
	gauge(out, "gopura_terminal_temperature_celsius",
	      "Temperature of the hottest thermal zone.", m->temperature_c);
	gauge(out, "gopura_terminal_memory_bytes", "Memory of the computer.", m->memory_bytes);
	gauge(out, "gopura_terminal_memory_free_bytes", "Memory available to programs.",
	      m->memory_free_bytes);
	gauge(out, "gopura_terminal_data_bytes", "Size of the data partition.", m->data_bytes);
	gauge(out, "gopura_terminal_data_free_bytes", "Free space on the data partition.",
	      m->data_free_bytes);
	if (!isnan(m->written_bytes))
		metrics_counter(out, "gopura_terminal_written_bytes_total",
				"Bytes written to all disks since the computer started.",
				m->written_bytes);
	metrics_info(out, "gopura_terminal_info", "Host name and firmware slot.",
		     (const struct figure_label[]){ { "name", m->name }, { "slot", m->slot } }, 2);
}

/* ---- any page */

int web_page_write(struct buffer *out, const char **type, enum web_page page,
		   const struct snapshot *snapshot, const struct verdict *verdict)
{
	switch (page) {
	case WEB_PAGE_OVERVIEW:
		*type = "text/html";
		overview_write(out, snapshot, verdict);
		return 200;
	case WEB_PAGE_METRICS:
		*type = "text/plain; version=0.0.4";
		write_metrics(out, snapshot, verdict);
		return 200;
	case WEB_PAGE_HEALTH:
		*type = "text/plain";
		return write_health(out, verdict);
	case WEB_PAGE_VISITS:
	case WEB_PAGE_NONE:
		break;
	}
	return 404;
}
