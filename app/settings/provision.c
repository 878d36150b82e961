/* Reads gopura.conf and the board profile, and merges their values into the options that the
 * command line left open. */
#include "app/settings/provision.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "app/release/trust.h"
#include "base/log.h"
#include "base/safe_open.h"
#include "tuf/tuf_metadata.h"

/* ---- reading and merging */

/* Reads the first of the files that exists. */
static void read_file(struct provision *provision, const struct options *options)
{
	provision->terminal = terminal_default;
	for (uint32_t i = 0; i < options->conf_count && !provision->path; i++)
		if (terminal_read(&provision->terminal, options->conf_paths[i],
				  options->board_path ? NULL : options->boards_dir,
				  &provision->diagnostics) == 0)
			provision->path = options->conf_paths[i];
}

/* Writes the path of a file beside gopura.conf to out and returns it; NULL if name is empty. */
static const char *beside(const struct provision *provision, const char *name, char out[PATH_MAX])
{
	const char *slash = strrchr(provision->path, '/');

	if (!*name)
		return NULL;
	snprintf(out, PATH_MAX, "%.*s%s", slash ? (int)(slash - provision->path) + 1 : 0,
		 provision->path, name);
	return out;
}

/* Returns the path of the trust root that gopura.conf names, or NULL after adding a diagnostic. The
 * file is checked here, because an invalid one would make every start fail. */
static const char *checked_trust(struct provision *provision)
{
	const char *path = beside(provision, provision->terminal.trust, provision->trust_path);
	struct trust trust = { .sequence_floor = 0 };
	struct tuf_file tuf = { 0 };
	const char *why = "", *unused;
	struct buffer file;
	int rc;

	if (!path)
		return NULL;
	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	rc = buffer_read_foreign(&file, path);
	if (rc == 0)
		rc = trust_pin(&trust, buffer_bytes(&file), &why) == 0 ||
				     tuf_root_first(&tuf, buffer_bytes(&file), &unused) == 0
			     ? 0
			     : -EBADMSG;
	else
		why = open_problem(rc);
	tuf_file_finish(&tuf);
	buffer_finish(&file);
	if (rc == 0)
		return path;
	diagnostics_add(&provision->diagnostics, -EINVAL, NULL, 0,
			"%s is no trust root (%s); copy the release's root/1.json there once more",
			provision->terminal.trust, why);
	return NULL;
}

static const char *text_or(const char *option, const char *text)
{
	return option || !*text ? option : text;
}

static void merge(struct provision *provision, struct options *options)
{
	const struct terminal *terminal = &provision->terminal;

	options->release_url = text_or(options->release_url, terminal->release_url);
	options->language = text_or(options->language, terminal->language);
	if (!options->trust_path)
		options->trust_path = checked_trust(provision);
	options->target = text_or(options->target, terminal->target);
	if (!options->ca_path)
		options->ca_path = beside(provision, terminal->ca, provision->ca_path);
	options->redirect_hosts = text_or(options->redirect_hosts, terminal->redirect_hosts);
	if (options->poll_s == 0)
		options->poll_s = terminal->poll_s;
	if (options->download.from_min == options->download.until_min)
		options->download = terminal->download;
	if (options->width_px == 0) {
		options->width_px = terminal->width_px;
		options->height_px = terminal->height_px;
		options->hz = terminal->hz;
	}
	if (memcmp(&options->hours, &terminal_default.hours, sizeof(options->hours)) == 0)
		options->hours = terminal->hours;
	options->shift = options->shift || terminal->shift;
	/* Opening hours and download times are in this place's time zone, so it overrides the
	 * system's. */
	if (terminal->time_zone[0] && setenv("TZ", terminal->time_zone, 0) == 0)
		tzset();
}

static int read_profile(struct provision *provision, const struct options *options,
			struct profile *out)
{
	const struct terminal *terminal = &provision->terminal;
	const char *path = options->board_path;
	int rc;

	if (!path && terminal->board[0]) {
		snprintf(provision->board_path, PATH_MAX, "%s/%s.ini", options->boards_dir,
			 terminal->board);
		path = provision->board_path;
	}
	rc = profile_read(out, path);
	if (rc < 0 && path == provision->board_path) {
		diagnostics_add(
			&provision->diagnostics, -EINVAL, NULL, 0,
			"the profile of the board '%s' has faults (the log names them); what is "
			"right of it holds",
			terminal->board);
		rc = 0;
	}
	if (terminal->rotation_deg >= 0)
		out->rotation_deg = terminal->rotation_deg;
	if (options->budget_triangles > 0)
		out->triangles = (uint32_t)options->budget_triangles;
	return rc;
}

int provision_read(struct provision *provision, struct options *options, struct profile *profile)
{
	int rc;

	provision->diagnostics.max = SETTINGS_DIAGNOSTICS_MAX;
	read_file(provision, options);
	if (provision->path)
		merge(provision, options);
	if (options->wake_min < 0)
		options->wake_min = (int)provision->terminal.wake_min;
	if (options->loudness < 0)
		options->loudness = (int)provision->terminal.loudness;
	if (options->idle_s == 0)
		options->idle_s = (int)provision->terminal.idle_s;
	rc = read_profile(provision, options, profile);
	for (unsigned i = 0; i < provision->diagnostics.count; i++)
		log_error("app", "set-up bug: %s: %s", provision->path,
			  diagnostics_get(&provision->diagnostics, i)->text);
	if (provision->diagnostics.dropped > 0)
		log_error("app", "set-up bug: %s: and %u more faults", provision->path,
			  provision->diagnostics.dropped);
	if (!provision->path && options->conf_count > 0)
		log_warn("app", "%s does not exist; the defaults are used (docs/terminal.md)",
			 options->conf_paths[0]);
	return rc;
}

void provision_finish(struct provision *provision)
{
	diagnostics_finish(&provision->diagnostics);
}
