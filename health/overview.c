/* Writes the HTML page for people: the verdict, the findings, and tables of what is shown and of
 * the machine's values. */
#include "health/overview.h"

#include <math.h>
#include <string.h>
#include <time.h>

/* No script, no image and nothing from other servers: the page must open in any browser, on a
 * network without internet. */
static const char style[] =
	":root{color-scheme:light dark;--paper:#f6f4ef;--sheet:#fff;--ink:#22201c;--soft:#6b665c;--line:#e2ddd2;"
	"--ok:#2f7d4f;--warning:#9a650c;--critical:#b3372b}"
	"@media(prefers-color-scheme:dark){:root{--paper:#1a1917;--sheet:#242220;--ink:#ece8df;--soft:#a49d8f;"
	"--line:#3a3733;--ok:#35804f;--warning:#a36c10;--critical:#c9483a}}"
	"*{box-sizing:border-box}"
	"body{margin:0;background:var(--paper);color:var(--ink);font:16px/1.5 system-ui,sans-serif}"
	"main{max-width:52rem;margin:0 auto;padding:1.25rem 1rem 3rem}"
	"header{color:#fff;padding:1.1rem 1rem;background:var(--level)}"
	"header>div{max-width:50rem;margin:0 auto;display:flex;gap:1rem;align-items:center}"
	"header svg{flex:none;width:3.2rem;height:3.2rem}"
	"h1{margin:0;font-size:1.6rem;line-height:1.2}header p{margin:.2rem 0 0;opacity:.9}"
	"h2{font-size:1rem;margin:2rem 0 .6rem;color:var(--soft);font-weight:600}"
	"article{background:var(--sheet);border:1px solid var(--line);border-left:.45rem solid var(--level);"
	"border-radius:.4rem;padding:.8rem 1rem;margin:.8rem 0}"
	"article h3{margin:0;font-size:1.1rem}article p{margin:.35rem 0 0;overflow-wrap:anywhere}"
	"article .detail{color:var(--soft)}"
	".ok{--level:var(--ok)}.warning{--level:var(--warning)}.critical{--level:var(--critical)}"
	"table{width:100%;border-collapse:collapse;background:var(--sheet);border:1px solid var(--line)}"
	"th,td{text-align:left;vertical-align:top;padding:.45rem .8rem;border-top:1px solid var(--line)}"
	"tr:first-child>*{border-top:0}th{width:13rem;font-weight:500;color:var(--soft)}"
	"td{overflow-wrap:anywhere;font-variant-numeric:tabular-nums}"
	"meter{width:7rem;height:.9rem;margin-right:.6rem;vertical-align:-.1rem}"
	"footer{margin-top:1.5rem;color:var(--soft);font-size:.9rem}a{color:inherit}"
	"@media(max-width:34rem){th,td{display:block;width:auto;padding:.4rem .8rem}td{border:0;padding-top:0}}";

static const char *const classes[LEVEL_COUNT] = { "ok", "warning", "critical" };

static const char *const signs[LEVEL_COUNT] = {
	"<path d='M14 25l8 8 13-17'/>",
	"<path d='M24 12v14'/><path d='M24 34v.5'/>",
	"<path d='M16 16l16 16M32 16L16 32'/>",
};

/* ---- pieces */

struct facts {
	struct buffer *out;
	const struct snapshot *snapshot;
};

/* Appends text as the content of an element or a quoted attribute: &, <, > and quotes are escaped.
 * Control characters and non-ASCII bytes are passed, because the page is UTF-8. */
static void put_html(struct buffer *out, const char *text)
{
	while (*text) {
		const size_t plain = strcspn(text, "&<>\"'");

		buffer_put(out, text, plain);
		text += plain;
		if (*text)
			buffer_print(out, "&#%d;", *text++);
	}
}

static double figure(const struct facts *facts, enum program program, const char *name)
{
	double value = NAN;

	metrics_find(buffer_bytes(&facts->snapshot->answers[program].text), name, &value);
	return value;
}

static void row(const struct facts *facts, const char *name)
{
	buffer_print(facts->out, "<tr><th scope=row>%s<td>", name);
}

static void put_bytes(struct buffer *out, double bytes)
{
	static const char *const units[] = { "B", "kB", "MB", "GB", "TB" };
	size_t unit = 0;

	for (; bytes >= 999.5 && unit + 1 < ARRAY_COUNT(units); unit++)
		bytes /= 1000;
	buffer_print(out, bytes < 10 && unit > 0 ? "%.1f %s" : "%.0f %s", bytes, units[unit]);
}

/* Writes how much of a whole is used; nothing if it is not known. */
static void put_share(const struct facts *facts, double used, double whole, const char *what)
{
	if (!(whole > 0) || !(used >= 0))
		return;
	buffer_print(facts->out, "<meter min=0 max=1 high=.93 optimum=.2 value=%.3f></meter>",
		     used / whole);
	put_bytes(facts->out, used);
	buffer_put_text(facts->out, " of ");
	put_bytes(facts->out, whole);
	buffer_print(facts->out, " %s<br>", what);
}

static void put_duration(struct buffer *out, double seconds)
{
	char text[40];

	verdict_duration(text, sizeof(text), seconds);
	buffer_put_text(out, text);
}

/* ---- rows */

static void write_release(const struct facts *facts)
{
	const struct bytes kiosk = buffer_bytes(&facts->snapshot->answers[PROGRAM_KIOSK].text);
	const double sequence = figure(facts, PROGRAM_KIOSK, "gopura_kiosk_release_sequence");
	char name[200], root[80];

	row(facts, "Release");
	if (!metrics_label(kiosk, "gopura_kiosk_release_info", "root", root, sizeof(root))) {
		buffer_put_text(facts->out, kiosk.size ? "none" : "unknown");
		return;
	}
	metrics_label(kiosk, "gopura_kiosk_release_info", "name", name, sizeof(name));
	put_html(facts->out, name);
	if (sequence > 0)
		buffer_print(facts->out, ", version %.0f", sequence);
	buffer_put_text(facts->out, " <small>(");
	put_html(facts->out, root);
	buffer_put_text(facts->out, ")</small>");
}

static void write_server(const struct facts *facts)
{
	const double online = figure(facts, PROGRAM_FETCH, "gopura_fetch_online");
	const double since_s = figure(facts, PROGRAM_FETCH, "gopura_fetch_offline_since_seconds");

	row(facts, "Museum server");
	if (isnan(online)) {
		buffer_put_text(facts->out, "unknown");
		return;
	}
	if (online == 0 && since_s > 0) {
		buffer_put_text(facts->out, "has not responded for ");
		put_duration(facts->out, (double)facts->snapshot->taken_wall_s - since_s);
	} else {
		buffer_put_text(facts->out, online > 0 ? "responds" : "does not respond");
	}
	buffer_put_text(facts->out, "; ");
	put_bytes(facts->out, figure(facts, PROGRAM_FETCH, "gopura_fetch_received_bytes_total"));
	buffer_print(facts->out, " received; %.0f of %.0f requests failed",
		     figure(facts, PROGRAM_FETCH, "gopura_fetch_errors_total"),
		     figure(facts, PROGRAM_FETCH, "gopura_fetch_requests_total"));
}

/* One of the times at which something that is signed expires. */
static void put_expiry(const struct facts *facts, const char *before, const char *name)
{
	const double left_s =
		figure(facts, PROGRAM_KIOSK, name) - (double)facts->snapshot->taken_wall_s;

	if (isnan(left_s))
		return;
	buffer_put_text(facts->out, before);
	put_duration(facts->out, fabs(left_s));
	if (left_s < 0)
		buffer_put_text(facts->out, " ago");
}

static void write_trust(const struct facts *facts)
{
	const double version = figure(facts, PROGRAM_KIOSK, "gopura_kiosk_trust_root_version");

	if (!(version > 0))
		return;
	row(facts, "Signatures");
	buffer_print(facts->out, "root %.0f%s", version,
		     figure(facts, PROGRAM_KIOSK, "gopura_kiosk_trust_tuf") == 1
			     ? " of The Update Framework"
			     : "");
	put_expiry(facts, ", expires in ", "gopura_kiosk_trust_root_expires_at_seconds");
	put_expiry(facts, "; timestamp ", "gopura_kiosk_trust_timestamp_expires_at_seconds");
	put_expiry(facts, "; release ", "gopura_kiosk_trust_release_expires_at_seconds");
}

static void write_refusal(const struct facts *facts, enum program program, const char *name,
			  const char *at, const char *info)
{
	const struct bytes text = buffer_bytes(&facts->snapshot->answers[program].text);
	char what[120], why[200];

	if (!metrics_label(text, info, "what", what, sizeof(what)))
		return;
	metrics_label(text, info, "why", why, sizeof(why));
	row(facts, name);
	put_html(facts->out, what);
	buffer_put_text(facts->out, ", ");
	put_duration(facts->out,
		     (double)facts->snapshot->taken_wall_s - figure(facts, program, at));
	buffer_put_text(facts->out, " ago: ");
	put_html(facts->out, why);
}

static void write_panel(const struct facts *facts)
{
	const struct bytes kiosk = buffer_bytes(&facts->snapshot->answers[PROGRAM_KIOSK].text);
	const double touch = figure(facts, PROGRAM_KIOSK, "gopura_kiosk_touch_devices");
	char renderer[120];

	if (kiosk.size == 0)
		return;
	row(facts, "Frames");
	buffer_print(facts->out, "%.0f drawn, %.0f of them late; the last one ",
		     figure(facts, PROGRAM_KIOSK, "gopura_kiosk_frames_total"),
		     figure(facts, PROGRAM_KIOSK, "gopura_kiosk_late_frames_total"));
	put_duration(facts->out,
		     figure(facts, PROGRAM_KIOSK, "gopura_kiosk_last_frame_age_seconds"));
	buffer_put_text(facts->out, " ago (none are drawn while nothing moves)");
	row(facts, "Graphics");
	metrics_label(kiosk, "gopura_kiosk_gl_info", "renderer", renderer, sizeof(renderer));
	put_html(facts->out, renderer);
	if (!isnan(touch)) {
		row(facts, "Touchscreens");
		buffer_print(facts->out, "%.0f", touch);
	}
	row(facts, "Graphics memory");
	put_share(facts, figure(facts, PROGRAM_KIOSK, "gopura_kiosk_texture_bytes"),
		  figure(facts, PROGRAM_KIOSK, "gopura_kiosk_texture_budget_bytes"), "for images");
	put_share(facts, figure(facts, PROGRAM_KIOSK, "gopura_kiosk_geometry_bytes"),
		  figure(facts, PROGRAM_KIOSK, "gopura_kiosk_geometry_budget_bytes"),
		  "for geometry");
}

static void write_machine(const struct facts *facts)
{
	const struct machine *m = &facts->snapshot->machine;

	if (!isnan(m->temperature_c)) {
		row(facts, "Temperature");
		buffer_print(facts->out, "%.0f °C", m->temperature_c);
	}
	row(facts, "Memory");
	put_share(facts, m->memory_bytes - m->memory_free_bytes, m->memory_bytes, "in use");
	row(facts, "Disk");
	put_share(facts, m->data_bytes - m->data_free_bytes, m->data_bytes, "in use");
	put_share(facts, figure(facts, PROGRAM_FETCH, "gopura_fetch_cache_bytes"),
		  figure(facts, PROGRAM_FETCH, "gopura_fetch_cache_budget_bytes"),
		  "used by the download cache");
	if (!isnan(m->written_bytes)) {
		row(facts, "Written to disks");
		put_bytes(facts->out, m->written_bytes);
		buffer_put_text(facts->out, " since the computer started");
	}
	row(facts, "Running for");
	put_duration(facts->out, m->uptime_s);
	if (m->slot[0]) {
		row(facts, "Firmware");
		buffer_put_text(facts->out, "slot ");
		put_html(facts->out, m->slot);
	}
}

static void write_program(const struct facts *facts, enum program program, const char *name,
			  const char *uptime, const char *starts, const char *memory)
{
	row(facts, name);
	if (facts->snapshot->answers[program].rc < 0) {
		buffer_put_text(facts->out, "does not respond");
		return;
	}
	buffer_put_text(facts->out, "running for ");
	put_duration(facts->out, figure(facts, program, uptime));
	buffer_print(facts->out, ", started %.0f time%s, uses ", figure(facts, program, starts),
		     figure(facts, program, starts) == 1 ? "" : "s");
	put_bytes(facts->out, figure(facts, program, memory));
}

/* ---- the page */

static void write_head(const struct facts *facts, const struct verdict *verdict)
{
	static const char *const words[LEVEL_COUNT] = { "Everything works", "Works, with a warning",
							"Needs attention" };
	const char *word = words[verdict->level];

	if (verdict->level == LEVEL_WARNING && verdict->count > 1)
		word = "Works, with warnings";
	buffer_put_text(facts->out, "<!doctype html><html lang=en><meta charset=utf-8>"
				    "<meta name=viewport content='width=device-width'>"
				    "<meta http-equiv=refresh content=10><title>");
	put_html(facts->out, facts->snapshot->machine.name);
	buffer_print(facts->out, ": %s</title><style>", word);
	buffer_put_text(facts->out, style);
	buffer_print(facts->out,
		     "</style><header class=%s><div><svg viewBox='0 0 48 48' fill=none stroke=#fff "
		     "stroke-width=4 stroke-linecap=round stroke-linejoin=round aria-hidden=true>"
		     "<circle cx=24 cy=24 r=21 />%s</svg><div><h1>%s</h1><p>",
		     classes[verdict->level], signs[verdict->level], word);
	put_html(facts->out, facts->snapshot->machine.name);
	buffer_put_text(facts->out, "</div></div></header><main>");
}

static void write_findings(struct buffer *out, const struct verdict *verdict)
{
	for (size_t i = 0; i < verdict->count; i++) {
		const struct finding *finding = &verdict->findings[i];

		buffer_print(out, "<article class=%s><h3>", classes[finding->level]);
		put_html(out, finding->what);
		buffer_put_text(out, "</h3>");
		if (finding->detail[0]) {
			buffer_put_text(out, "<p class=detail>");
			put_html(out, finding->detail);
		}
		buffer_put_text(out, "<p>");
		put_html(out, finding->action);
		buffer_put_text(out, "</article>");
	}
}

void overview_write(struct buffer *out, const struct snapshot *snapshot,
		    const struct verdict *verdict)
{
	const struct facts facts = { out, snapshot };
	const time_t taken_s = (time_t)snapshot->taken_wall_s;
	char when[40];
	struct tm local;

	write_head(&facts, verdict);
	write_findings(out, verdict);
	buffer_put_text(out, "<h2>Content</h2><table>");
	write_release(&facts);
	write_trust(&facts);
	write_server(&facts);
	write_refusal(&facts, PROGRAM_KIOSK, "Last rejected release",
		      "gopura_kiosk_refused_at_seconds", "gopura_kiosk_refusal_info");
	write_refusal(&facts, PROGRAM_FETCH, "Last failed download",
		      "gopura_fetch_refused_at_seconds", "gopura_fetch_refusal_info");
	write_panel(&facts);
	buffer_put_text(out, "</table><h2>Computer</h2><table>");
	write_machine(&facts);
	write_program(&facts, PROGRAM_KIOSK, "gopura-kiosk", "gopura_kiosk_uptime_seconds",
		      "gopura_kiosk_starts_total", "gopura_kiosk_resident_bytes");
	write_program(&facts, PROGRAM_FETCH, "gopura-fetch", "gopura_fetch_uptime_seconds",
		      "gopura_fetch_starts_total", "gopura_fetch_resident_bytes");
	strftime(when, sizeof(when), "%Y-%m-%d %H:%M:%S", localtime_r(&taken_s, &local));
	buffer_print(
		out,
		"</table><footer>Measured at %s (clock of this terminal). The page reloads every 10 "
		"seconds.<br><a href=/metrics>Metrics</a> for Prometheus · <a href=/health>status</a> "
		"for scripts · <a href=/visits.csv>anonymous counts</a> of what visitors look at"
		"</footer></main>\n",
		when);
}
