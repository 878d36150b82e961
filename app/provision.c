#include "app/provision.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "app/kiosk.h"
#include "app/update.h"
#include "base/clock.h"
#include "base/log.h"
#include "ui/notice.h"

enum {
	PAGE_LEAST_MS = 30000,
	PAGE_FADE_MS = 600,
	PAGE_TEXTURE = OVERLAY_BITMAPS_MOST, /* the first that no overlay has */
	HINTS_MOST = 3,
};

/* ---- from the file */

/* The first of the files that is there. */
static void read_file(struct provision *provision, const struct options *options)
{
	provision->terminal = terminal_default;
	for (uint32_t i = 0; i < options->conf_count && !provision->path; i++)
		if (terminal_read(&provision->terminal, options->conf_paths[i],
				  options->board_path ? NULL : options->boards_dir,
				  &provision->faults) == 0)
			provision->path = options->conf_paths[i];
}

/* The path of a file beside gopura.conf; NULL: it names none. */
static const char *beside(const struct provision *provision, const char *name, char out[PATH_MAX])
{
	const char *slash = strrchr(provision->path, '/');

	if (!*name)
		return NULL;
	snprintf(out, PATH_MAX, "%.*s%s", slash ? (int)(slash - provision->path) + 1 : 0,
		 provision->path, name);
	return out;
}

/* A file that is no trust root would end every start. */
static const char *checked_trust(struct provision *provision)
{
	const char *path = beside(provision, provision->terminal.trust, provision->trust_path);
	struct update update = { .sequence_floor = 0 };
	const char *why = "";
	struct buffer file;
	int rc;

	if (!path)
		return NULL;
	buffer_init(&file, METADATA_FILE_BYTES_MOST);
	rc = buffer_read_file(&file, path);
	if (rc == 0)
		rc = update_pin(&update, buffer_bytes(&file), &why);
	else
		why = strerror(-rc);
	buffer_finish(&file);
	if (rc == 0)
		return path;
	faults_add(&provision->faults, 0,
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
	if (!options->ca_path)
		options->ca_path = beside(provision, terminal->ca, provision->ca_path);
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
	/* Opening hours and the time to download are this place's, whatever the system has. */
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
		faults_add(&provision->faults, 0,
			   "the profile of the board '%s' has faults (the log names them); what is "
			   "right of it holds",
			   terminal->board);
		rc = 0;
	}
	if (terminal->rotation_deg >= 0)
		out->rotation_deg = terminal->rotation_deg;
	return rc;
}

int provision_read(struct provision *provision, struct options *options, struct profile *profile)
{
	int rc;

	read_file(provision, options);
	if (provision->path)
		merge(provision, options);
	if (options->wake_min < 0)
		options->wake_min = (int)provision->terminal.wake_min;
	if (options->idle_s == 0)
		options->idle_s = (int)provision->terminal.idle_s;
	rc = read_profile(provision, options, profile);
	for (unsigned i = 0; i < provision->faults.count; i++)
		log_error("app", "set-up bug: %s: %s", provision->path,
			  provision->faults.list[i].text);
	if (provision->faults.dropped > 0)
		log_error("app", "set-up bug: %s: and %u more", provision->path,
			  provision->faults.dropped);
	if (!provision->path && options->conf_count > 0)
		log_warn("app", "there is no %s: going on without (docs/terminal.md)",
			 options->conf_paths[0]);
	return rc;
}

/* ---- onto the panel */

static int draw_page(struct kiosk *kiosk, const struct notice *notice)
{
	return notice_draw(&kiosk->provision.page, notice, kiosk->px_per_mm, kiosk_width_px(kiosk),
			   kiosk_height_px(kiosk), NULL);
}

static int draw_faults(struct kiosk *kiosk)
{
	const struct faults *faults = &kiosk->provision.faults;
	struct notice_item items[FAULTS_MOST];
	char marks[FAULTS_MOST][20], lead[PATH_MAX + 64];
	const struct notice notice = {
		.title = "gopura.conf needs mending",
		.lead = lead,
		.items = items,
		.count = faults->count,
		.dropped = faults->dropped,
		.foot = "Correct the file on any computer, then switch the terminal off and on; a "
			"stick need only be plugged in again. gopura-setup --check gopura.conf "
			"tells beforehand whether it is right.",
	};

	for (unsigned i = 0; i < faults->count; i++) {
		const char *text = faults->list[i].text;

		marks[i][0] = '\0';
		if (faults->list[i].line > 0) {
			snprintf(marks[i], sizeof(marks[i]), "line %u", faults->list[i].line);
			text = strchr(text, ':') + 2; /* the mark says its beginning */
		}
		items[i] = (struct notice_item){ .mark = marks[i], .text = text };
	}
	snprintf(lead, sizeof(lead), "%s. What is right in it is in use.", kiosk->provision.path);
	return draw_page(kiosk, &notice);
}

static int draw_missing(struct kiosk *kiosk)
{
	const struct options *options = &kiosk->options;
	char where[OPTIONS_CONFS_MOST * 256] = "Save it as ";
	const struct notice_item items[HINTS_MOST] = {
		{ "1", "On any computer write a text file gopura.conf:\n"
		       "[release]\n"
		       "url = https://museum.example/temple/\n"
		       "trust = 1.json" },
		{ "2", where },
		{ "3", "Switch the terminal off and on; a stick need only be plugged in." },
	};
	const struct notice notice = {
		.title = "This terminal is not set up yet",
		.lead = "It does not know where its temple is.",
		.items = items,
		.count = HINTS_MOST,
		.foot = "Of the appliance /efi is the partition gopura-esp of its disk, and "
			"/run/gopura-stick any USB stick. What else the file may say stands in "
			"docs/terminal.md: language, panel, opening hours, network, Wi-Fi.",
	};

	for (uint32_t i = 0; i < options->conf_count; i++) {
		const size_t length = strlen(where);

		snprintf(where + length, sizeof(where) - length, "%s%.200s", i > 0 ? " or " : "",
			 options->conf_paths[i]);
	}
	snprintf(where + strlen(where), sizeof(where) - strlen(where),
		 ", and the release's root/1.json beside it as 1.json.");
	return draw_page(kiosk, &notice);
}

int provision_show(struct kiosk *kiosk)
{
	struct provision *provision = &kiosk->provision;
	/* Nothing to show, and no key to trust what may come. */
	const bool is_unset =
		kiosk->options.conf_count > 0 && !kiosk->options.trust_path && !kiosk->shown.scene;

	if (is_unset && !provision->path)
		return draw_missing(kiosk);
	if (is_unset && !provision->terminal.release_url[0] && provision->faults.count == 0)
		faults_add(&provision->faults, 0,
			   "under [release] the lines url = ... and trust = ... are missing; they "
			   "say where the temple is and whose key to trust");
	return provision->faults.count > 0 ? draw_faults(kiosk) : 0;
}

void provision_finish(struct provision *provision)
{
	bitmap_finish(&provision->page);
}

bool provision_covers(const struct kiosk *kiosk)
{
	return kiosk->provision.page.surface && kiosk->provision.page_leaves_ms == 0;
}

/* What it covers; -1: nothing that could be shown yet. */
static int64_t leaves_in_ms(const struct kiosk *kiosk, int64_t now_ms)
{
	const int64_t due_ms = kiosk->provision.page_since_ms + PAGE_LEAST_MS;

	if (!kiosk->pictured || kiosk->provision.page_since_ms == 0)
		return -1;
	return due_ms > now_ms ? due_ms - now_ms : 0;
}

static void draw_over(struct kiosk *kiosk, float alpha)
{
	const float w = (float)kiosk->provision.page.width_px;
	const float h = (float)kiosk->provision.page.height_px;
	const float corners[4][2] = { { 0, 0 }, { w, 0 }, { w, h }, { 0, h } };
	const float whole[4] = { 0, 0, 1, 1 };

	quads_draw(kiosk->quads, PAGE_TEXTURE, corners, whole, alpha);
}

int provision_draw(struct kiosk *kiosk, int64_t now_ms)
{
	struct provision *provision = &kiosk->provision;
	const struct quads_pixels pixels = {
		.id = PAGE_TEXTURE,
		.revision = 1,
		.width_px = provision->page.width_px,
		.height_px = provision->page.height_px,
		.stride_bytes = provision->page.stride_bytes,
		.bgra = provision->page.pixels,
	};
	const int unmoved_px[2] = { 0, 0 }; /* it covers the panel to its edges */
	float alpha = 1;
	int rc;

	if (!provision->page.surface)
		return 0;
	if (provision->page_since_ms == 0)
		provision->page_since_ms = now_ms;
	if (provision->page_leaves_ms == 0 && leaves_in_ms(kiosk, now_ms) == 0)
		provision->page_leaves_ms = now_ms;
	if (provision->page_leaves_ms > 0) {
		alpha = 1 - (float)(now_ms - provision->page_leaves_ms) / PAGE_FADE_MS;
		kiosk_redraw(kiosk);
	}
	if (alpha <= 0) {
		quads_drop(kiosk->quads, PAGE_TEXTURE);
		provision_finish(provision);
		return 0;
	}
	quads_begin(kiosk->quads, unmoved_px, display_width_px(kiosk->display),
		    display_height_px(kiosk->display), kiosk->profile.rotation_deg);
	rc = quads_upload(kiosk->quads, &pixels);
	if (rc == 0)
		draw_over(kiosk, alpha);
	quads_end(kiosk->quads);
	return rc;
}

int provision_wait_ms(const struct kiosk *kiosk)
{
	return provision_covers(kiosk) ? (int)leaves_in_ms(kiosk, clock_now_ms()) : -1;
}
