/* Judges a snapshot by fixed rules: each rule that fails adds a finding with what is wrong and what
 * to do. */
#include "health/verdict.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
	PICTURE_S = 120,    /* a picture must be there so long after the kiosk's start */
	TOGETHER_S = 60,    /* kiosk and fetcher must be connected so long after their start */
	OFFLINE_S = 300,    /* shorter interruptions are normal */
	CLOCK_S = 900,      /* the clock must be set so long after boot */
	RESTARTED_S = 3600, /* a restart is reported for so long */
	REFUSED_S = 86400,
	FRAMES_MIN = 500, /* frames needed to judge the share of late ones */
	HOT_C = 80,
	BURNING_C = 95,
};

/* Limits as shares: late frames, free memory, free data partition. */
static const double late_most = 0.2, memory_low = 0.08, memory_out = 0.03, data_low = 0.05;

static void add(struct verdict *verdict, enum level level, const char *what, const char *action,
		const char *detail, ...) printf_like(5, 6);

static void add(struct verdict *verdict, enum level level, const char *what, const char *action,
		const char *detail, ...)
{
	struct finding *finding = verdict->findings;
	size_t at = 0;
	va_list args;

	if (verdict->count == FINDINGS_MAX)
		return;
	while (at < verdict->count && finding[at].level >= level)
		at++;
	memmove(&finding[at + 1], &finding[at], (verdict->count - at) * sizeof(*finding));
	finding += at;
	verdict->count++;
	if (level > verdict->level)
		verdict->level = level;
	*finding = (struct finding){ .level = level, .what = what, .action = action };
	va_start(args, detail);
	vsnprintf(finding->detail, sizeof(finding->detail), detail, args);
	va_end(args);
}

void verdict_duration(char *out, size_t out_bytes, double seconds)
{
	static const struct {
		double seconds;
		const char *name;
	} units[] = { { 86400, "day" }, { 3600, "hour" }, { 60, "minute" }, { 1, "second" } };
	size_t i = 0;
	double count;

	/* Two of a smaller unit are more exact than one of a larger. */
	while (i + 1 < ARRAY_COUNT(units) && seconds < 2 * units[i].seconds)
		i++;
	count = floor(fmax(seconds, 0) / units[i].seconds);
	snprintf(out, out_bytes, "%.0f %s%s", count, units[i].name, count == 1 ? "" : "s");
}

/* Returns a metric of a program; NAN if it is not available. */
static double figure(const struct snapshot *snapshot, enum program program, const char *name)
{
	double value = NAN;

	metrics_find(buffer_bytes(&snapshot->answers[program].text), name, &value);
	return value;
}

/* ---- the programs */

static const char *why_silent(int rc)
{
	switch (rc) {
	case -ENOENT:
		return "It is not running: it was stopped, or has not started yet.";
	case -ECONNREFUSED:
		return "It has exited and was not restarted yet.";
	case -ETIMEDOUT:
		return "It is running but does not respond: it hangs.";
	case -EBADMSG:
		return "Its response is not valid.";
	default:
		return strerror(-rc);
	}
}

static void judge_programs(struct verdict *verdict, const struct snapshot *snapshot)
{
	const int kiosk = snapshot->answers[PROGRAM_KIOSK].rc;
	const int fetch = snapshot->answers[PROGRAM_FETCH].rc;

	if (kiosk < 0)
		add(verdict, LEVEL_CRITICAL, "The display program does not respond",
		    "Visitors may see no picture, or cannot use it. The program (gopura-kiosk) is "
		    "restarted automatically within a minute. If this message stays, switch the "
		    "terminal off and on. If that does not help, save the output of journalctl -u "
		    "gopura-kiosk and contact the installer.",
		    "%s", why_silent(kiosk));
	if (fetch < 0)
		add(verdict, LEVEL_CRITICAL, "The download program does not respond",
		    "Visitors see only what is already loaded. The program (gopura-fetch) is "
		    "restarted automatically within a minute. If this message stays, switch the "
		    "terminal off and on. If that does not help, save the output of journalctl -u "
		    "gopura-fetch and contact the installer.",
		    "%s", why_silent(fetch));
}

static void judge_restart(struct verdict *verdict, const struct snapshot *snapshot,
			  enum program program, const char *starts, const char *uptime,
			  const char *what)
{
	const double count = figure(snapshot, program, starts);
	const double since_s = figure(snapshot, program, uptime);
	char ago[40];

	if (!(count > 1) || !(since_s < RESTARTED_S))
		return;
	verdict_duration(ago, sizeof(ago), since_s);
	add(verdict, LEVEL_WARNING, what,
	    "A single restart is harmless. If the number grows from day to day, save the output "
	    "of journalctl and contact the installer.",
	    "%s ago; %.0f restart%s since the computer started.", ago, count - 1,
	    count == 2 ? "" : "s");
}

/* ---- what visitors see and touch */

static void judge_picture(struct verdict *verdict, const struct snapshot *snapshot)
{
	const double since_s = figure(snapshot, PROGRAM_KIOSK, "gopura_kiosk_uptime_seconds");
	const double frames = figure(snapshot, PROGRAM_KIOSK, "gopura_kiosk_frames_total");
	const double late = figure(snapshot, PROGRAM_KIOSK, "gopura_kiosk_late_frames_total");
	char renderer[80];

	if (figure(snapshot, PROGRAM_KIOSK, "gopura_kiosk_picture") == 0 && since_s > PICTURE_S)
		add(verdict, LEVEL_CRITICAL, "No picture is shown",
		    "The terminal has not received a complete release yet. Check below whether the "
		    "museum server responds, and check [release] url and trust in gopura.conf.",
		    "%s", "");
	if (figure(snapshot, PROGRAM_KIOSK, "gopura_kiosk_touch_devices") == 0)
		add(verdict, LEVEL_CRITICAL, "The touchscreen does not work",
		    "No touchscreen is connected. Check the cable between panel and computer "
		    "(usually USB), then the power supply of the panel.",
		    "%s", "");
	metrics_label(buffer_bytes(&snapshot->answers[PROGRAM_KIOSK].text), "gopura_kiosk_gl_info",
		      "renderer", renderer, sizeof(renderer));
	if (strstr(renderer, "llvmpipe") || strstr(renderer, "softpipe"))
		add(verdict, LEVEL_WARNING, "The graphics driver is missing",
		    "The processor draws the pictures, which is slow and makes the computer hot. The "
		    "image has no driver for the GPU of this board, or its kernel module was not "
		    "loaded. Contact the installer.",
		    "%s", renderer);
	else if (frames >= FRAMES_MIN && late > late_most * frames)
		add(verdict, LEVEL_WARNING, "The picture does not move smoothly",
		    "The board is too slow for its settings. Set a smaller [panel] mode in "
		    "gopura.conf, or fewer triangles in the board profile (docs/board.md).",
		    "%.0f %% of the frames were late.", 100 * late / frames);
}

/* Judges refused releases. A fault in a release is found again at each look for a new one, so one
 * that was last found more than a day ago has been corrected. */
static void judge_refusal(struct verdict *verdict, const struct snapshot *snapshot)
{
	const struct bytes kiosk = buffer_bytes(&snapshot->answers[PROGRAM_KIOSK].text);
	const double ago_s = (double)snapshot->taken_wall_s -
			     figure(snapshot, PROGRAM_KIOSK, "gopura_kiosk_refused_at_seconds");
	char what[80], why[200], ago[40];

	if (!(ago_s < REFUSED_S))
		return;
	metrics_label(kiosk, "gopura_kiosk_refusal_info", "what", what, sizeof(what));
	metrics_label(kiosk, "gopura_kiosk_refusal_info", "why", why, sizeof(why));
	verdict_duration(ago, sizeof(ago), ago_s);
	add(verdict, LEVEL_WARNING, "A new release was rejected",
	    "Visitors see the previous release. Publish the release again, or renew the signature "
	    "that has expired (docs/release.md).",
	    "%s, %s ago: %s", what, ago, why);
}

/* Judges what must be signed anew. Nothing on the panel ever expires; only what is offered does, so
 * an update would be refused. days: begins to say so that many days before. */
static void judge_expiry(struct verdict *verdict, const struct snapshot *snapshot, const char *name,
			 int days, const char *what, const char *action)
{
	const double left_s =
		figure(snapshot, PROGRAM_KIOSK, name) - (double)snapshot->taken_wall_s;
	char time[40];

	if (!(left_s < days * 86400.0) ||
	    figure(snapshot, PROGRAM_KIOSK, "gopura_kiosk_clock_trusted") != 1)
		return;
	verdict_duration(time, sizeof(time), fabs(left_s));
	add(verdict, LEVEL_WARNING, what, action, left_s < 0 ? "Expired %s ago." : "%s left.",
	    time);
}

static void judge_trust(struct verdict *verdict, const struct snapshot *snapshot)
{
	judge_expiry(
		verdict, snapshot, "gopura_kiosk_trust_root_expires_at_seconds", 60,
		"The trust root must be renewed",
		"When it has expired, this terminal takes no new release; visitors go on seeing "
		"the last one. The publisher must sign the next root (docs/release.md).");
	judge_expiry(
		verdict, snapshot, "gopura_kiosk_trust_release_expires_at_seconds", 30,
		"The release must be signed again",
		"When it has expired, new terminals do not take it; this one goes on showing it. "
		"Sign it anew by gopura-content publish --renew, and where several teams publish, "
		"the museum's list of them by gopura-content delegate --renew (docs/tuf.md).");
	judge_expiry(
		verdict, snapshot, "gopura_kiosk_trust_timestamp_expires_at_seconds", 3,
		"The publisher's timestamp is old",
		"This terminal goes on showing what it has. If it has a network, the publisher "
		"has not signed for long: gopura-content publish --renew signs a new timestamp. "
		"If it has none, a stick with the release brings it (docs/release.md).");
}

/* Judges whether the server is reached. What failed before it was lost is no reason for that. */
static void judge_server(struct verdict *verdict, const struct snapshot *snapshot)
{
	const struct bytes fetch = buffer_bytes(&snapshot->answers[PROGRAM_FETCH].text);
	const double since_s =
		figure(snapshot, PROGRAM_FETCH, "gopura_fetch_offline_since_seconds");
	const double offline_s = (double)snapshot->taken_wall_s - since_s;
	char gone[40], why[200] = "";

	if (!(since_s > 0) || !(offline_s > OFFLINE_S))
		return;
	if (figure(snapshot, PROGRAM_FETCH, "gopura_fetch_refused_at_seconds") >= since_s)
		metrics_label(fetch, "gopura_fetch_refusal_info", "why", why, sizeof(why));
	verdict_duration(gone, sizeof(gone), offline_s);
	add(verdict, LEVEL_WARNING, "The museum server does not respond",
	    "Visitors see what was downloaded before. If the reason is a certificate, see "
	    "docs/server.md. Otherwise check the network cable or Wi-Fi, then whether another "
	    "computer in this network can open [release] url of gopura.conf.",
	    "No response for %s%s%s.", gone, why[0] ? ": " : "", why);
}

/* Judges failed writes of the last day: a disk that was full for a while is not worn out. */
static void judge_disk(struct verdict *verdict, const struct snapshot *snapshot)
{
	const double count = figure(snapshot, PROGRAM_FETCH, "gopura_fetch_cache_refused_total");
	const double ago_s =
		(double)snapshot->taken_wall_s -
		figure(snapshot, PROGRAM_FETCH, "gopura_fetch_cache_refused_at_seconds");
	char ago[40];

	if (!(count > 0) || !(ago_s < REFUSED_S))
		return;
	verdict_duration(ago, sizeof(ago), ago_s);
	add(verdict, LEVEL_WARNING, "The disk cannot be written",
	    "Downloads are not saved, so they may be missing after a power cut. The disk is "
	    "full or worn out. Check the free space below; if there is enough, replace the "
	    "card or disk.",
	    "%.0f write%s failed, the last one %s ago.", count, count == 1 ? "" : "s", ago);
}

static void judge_content(struct verdict *verdict, const struct snapshot *snapshot)
{
	if (figure(snapshot, PROGRAM_FETCH, "gopura_fetch_kiosk_connected") == 0 &&
	    figure(snapshot, PROGRAM_KIOSK, "gopura_kiosk_uptime_seconds") > TOGETHER_S &&
	    figure(snapshot, PROGRAM_FETCH, "gopura_fetch_uptime_seconds") > TOGETHER_S)
		add(verdict, LEVEL_WARNING, "The two programs are not connected",
		    "Nothing new is downloaded or shown. Switch the terminal off and on.", "%s",
		    "");
}

/* ---- the machine */

static void judge_machine(struct verdict *verdict, const struct snapshot *snapshot)
{
	const struct machine *m = &snapshot->machine;

	if (m->temperature_c >= HOT_C)
		add(verdict, m->temperature_c >= BURNING_C ? LEVEL_CRITICAL : LEVEL_WARNING,
		    "The computer is too hot",
		    "It slows down and wears out sooner. Clear its air vents, check its fan, and keep "
		    "it out of the sun.",
		    "%.0f °C.", m->temperature_c);
	if (m->memory_free_bytes < memory_low * m->memory_bytes)
		add(verdict,
		    m->memory_free_bytes < memory_out * m->memory_bytes ? LEVEL_CRITICAL
									: LEVEL_WARNING,
		    "Memory is low",
		    "Programs may be ended by the system. Switch the terminal off and on. If this "
		    "message returns, lower texture_mib and geometry_mib in the board profile.",
		    "%.0f of %.0f MB are free.", m->memory_free_bytes / 1e6, m->memory_bytes / 1e6);
	if (m->data_lost[0])
		add(verdict, LEVEL_WARNING, "Nothing is stored on the disk",
		    "Memory takes its place: each start loads everything again, from the system, a stick or "
		    "the museum server. If the TPM is to blame, switch it on in the firmware's setup (it may "
		    "be called fTPM, PTT or security device). Otherwise switch the terminal off and on; if "
		    "this message returns, replace the card or disk.",
		    "%s", m->data_lost);
	else if (m->data_free_bytes < data_low * m->data_bytes)
		add(verdict, LEVEL_WARNING, "The disk is nearly full",
		    "Soon, downloads can no longer be saved. Lower [cache] mib in the board profile, or "
		    "use a larger card or disk.",
		    "%.0f of %.0f MB are free.", m->data_free_bytes / 1e6, m->data_bytes / 1e6);
	if (m->data_plain[0])
		add(verdict, LEVEL_WARNING, "The data partition is not encrypted",
		    "This system should encrypt what it stores. Switch the TPM on in the firmware's setup "
		    "(it may be called fTPM, PTT or security device), then switch the terminal off and "
		    "on. What is stored is then lost and loaded again.",
		    "%s", m->data_plain);
	if (figure(snapshot, PROGRAM_KIOSK, "gopura_kiosk_clock_trusted") == 0 &&
	    m->uptime_s > CLOCK_S)
		add(verdict, LEVEL_WARNING, "The clock may be wrong",
		    "No time server has responded, so the terminal cannot tell whether a release has "
		    "expired. Check [network] ntp in gopura.conf.",
		    "%s", "");
}

/* Judges the system of an appliance, which has a slot. */
static void judge_system(struct verdict *verdict, const struct machine *m)
{
	if (m->slot[0] && m->newer[0])
		add(verdict, LEVEL_WARNING, "An older system runs",
		    "A newer one was good here, but no longer starts, or the power was cut several times "
		    "soon after a start. Leave the terminal on for ten minutes, then switch it off and on. "
		    "If this message stays, install the newer system again from a stick.",
		    "The newer one is %s.", m->newer);
	if (m->slot[0] && !m->is_set_up)
		add(verdict, LEVEL_WARNING, "gopura.conf was not applied",
		    "Network, museum server and name may be missing. Switch the terminal off and on. If this "
		    "message stays, save the output of journalctl -u gopura-setup and contact the installer.",
		    "%s", "");
}

/* gopura-setup writes one line for each entry of gopura.conf that it could not apply. */
static void judge_faults(struct verdict *verdict, const char *faults)
{
	while (*faults) {
		const size_t size = strcspn(faults, "\n");

		if (size > 0)
			add(verdict, LEVEL_WARNING, "gopura.conf has an error",
			    "The setting in this line is not used. Correct the line, then switch the terminal off "
			    "and on. If the file is on a USB stick, plug the stick in again instead.",
			    "%.*s", (int)size, faults);
		faults += size + (faults[size] == '\n');
	}
}

void verdict_judge(struct verdict *out, const struct snapshot *snapshot)
{
	memset(out, 0, sizeof(*out));
	judge_programs(out, snapshot);
	judge_picture(out, snapshot);
	judge_server(out, snapshot);
	judge_content(out, snapshot);
	judge_disk(out, snapshot);
	judge_refusal(out, snapshot);
	judge_trust(out, snapshot);
	judge_machine(out, snapshot);
	judge_system(out, &snapshot->machine);
	judge_restart(out, snapshot, PROGRAM_KIOSK, "gopura_kiosk_starts_total",
		      "gopura_kiosk_uptime_seconds", "The display program was restarted");
	judge_restart(out, snapshot, PROGRAM_FETCH, "gopura_fetch_starts_total",
		      "gopura_fetch_uptime_seconds", "The download program was restarted");
	judge_faults(out, snapshot->machine.faults);
}
