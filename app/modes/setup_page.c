/* Draws the page that lists the faults of gopura.conf, or says that the file is missing. The page
 * fades out after half a minute if the model can be shown. */
#include <stdio.h>
#include <string.h>

#include "app/kiosk.h"
#include "base/clock.h"
#include "ui/notice.h"

enum {
	PAGE_LEAST_MS = 30000,
	PAGE_FADE_MS = 600,
	PAGE_TEXTURE = OVERLAY_BITMAPS_MAX, /* the first texture id that the overlay does not use */
	HINTS_MAX = 3,
};

static int draw_page(struct kiosk *kiosk, const struct notice *notice)
{
	return notice_draw(&kiosk->setup_page.bitmap, notice, kiosk->px_per_mm,
			   kiosk_width_px(kiosk), kiosk_height_px(kiosk), NULL);
}

static int draw_faults(struct kiosk *kiosk)
{
	const struct faults *faults = &kiosk->provision.faults;
	struct notice_item items[FAULTS_MAX];
	char marks[FAULTS_MAX][20], lead[PATH_MAX + 64];
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
			text = strchr(text, ':') + 2; /* skip "line N: ", which the mark shows */
		}
		items[i] = (struct notice_item){ .mark = marks[i], .text = text };
	}
	snprintf(lead, sizeof(lead), "%s. What is right in it is in use.", kiosk->provision.path);
	return draw_page(kiosk, &notice);
}

static int draw_missing(struct kiosk *kiosk)
{
	const struct options *options = &kiosk->options;
	char where[OPTIONS_CONFS_MAX * 256] = "Save it as ";
	const struct notice_item items[HINTS_MAX] = {
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
		.count = HINTS_MAX,
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

int setup_page_show(struct kiosk *kiosk)
{
	struct provision *provision = &kiosk->provision;
	/* Nothing can be shown, and there is no trust root to check what may arrive. */
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

void setup_page_finish(struct kiosk *kiosk)
{
	bitmap_finish(&kiosk->setup_page.bitmap);
}

bool setup_page_covers(const struct kiosk *kiosk)
{
	return kiosk->setup_page.bitmap.surface && kiosk->setup_page.leaves_ms == 0;
}

/* Returns in how many milliseconds the page is to fade out; -1: not by time, because the model
 * cannot be shown yet or the page was not drawn. */
static int64_t leaves_in_ms(const struct kiosk *kiosk, int64_t now_ms)
{
	const int64_t due_ms = kiosk->setup_page.since_ms + PAGE_LEAST_MS;

	if (!kiosk->pictured || kiosk->setup_page.since_ms == 0)
		return -1;
	return due_ms > now_ms ? due_ms - now_ms : 0;
}

static void draw_over(struct kiosk *kiosk, float alpha)
{
	const float w = (float)kiosk->setup_page.bitmap.width_px;
	const float h = (float)kiosk->setup_page.bitmap.height_px;
	const float corners[4][2] = { { 0, 0 }, { w, 0 }, { w, h }, { 0, h } };
	const float whole[4] = { 0, 0, 1, 1 };

	quads_draw(kiosk->quads, PAGE_TEXTURE, corners, whole, alpha);
}

int setup_page_draw(struct kiosk *kiosk, int64_t now_ms)
{
	struct setup_page *page = &kiosk->setup_page;
	const struct quads_pixels pixels = {
		.id = PAGE_TEXTURE,
		.revision = 1,
		.width_px = page->bitmap.width_px,
		.height_px = page->bitmap.height_px,
		.stride_bytes = page->bitmap.stride_bytes,
		.bgra = page->bitmap.pixels,
	};
	const int unmoved_px[2] = { 0, 0 }; /* no shift: the page covers the panel to its edges */
	float alpha = 1;
	int rc;

	if (!page->bitmap.surface)
		return 0;
	if (page->since_ms == 0)
		page->since_ms = now_ms;
	if (page->leaves_ms == 0 && leaves_in_ms(kiosk, now_ms) == 0)
		page->leaves_ms = now_ms;
	if (page->leaves_ms > 0) {
		alpha = 1 - (float)(now_ms - page->leaves_ms) / PAGE_FADE_MS;
		kiosk_redraw(kiosk);
	}
	if (alpha <= 0) {
		quads_drop(kiosk->quads, PAGE_TEXTURE);
		setup_page_finish(kiosk);
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

int setup_page_wait_ms(const struct kiosk *kiosk)
{
	return setup_page_covers(kiosk) ? (int)leaves_in_ms(kiosk, clock_now_ms()) : -1;
}
