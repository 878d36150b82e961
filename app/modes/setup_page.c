/* Draws the page that lists the faults of gopura.conf, or says that the file is missing. The page
 * fades out after half a minute if the model can be shown. */
#include "app/modes/setup_page.h"

#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "ui/notice.h"
#include "ui/overlay.h"

enum {
	PAGE_LEAST_MS = 30000,
	PAGE_FADE_MS = 600,
	PAGE_TEXTURE = OVERLAY_BITMAPS_MAX, /* the first texture id that the overlay does not use */
	HINTS_MAX = 3,
};

void setup_page_init(struct setup_page *page, const struct viewport *viewport,
		     struct redraw *redraw)
{
	*page = (struct setup_page){ .viewport = viewport, .redraw = redraw };
}

static int draw_page(struct setup_page *page, const struct notice *notice)
{
	return notice_draw(&page->bitmap, notice, page->viewport->px_per_mm,
			   viewport_width_px(page->viewport), viewport_height_px(page->viewport),
			   NULL);
}

static int draw_faults(struct setup_page *page, const struct provision *provision)
{
	const struct diagnostics *diagnostics = &provision->diagnostics;
	struct notice_item items[SETTINGS_DIAGNOSTICS_MAX];
	char marks[SETTINGS_DIAGNOSTICS_MAX][20], lead[PATH_MAX + 64];
	const struct notice notice = {
		.title = "gopura.conf contains errors",
		.lead = lead,
		.items = items,
		.count = diagnostics->count,
		.dropped = diagnostics->dropped,
		.foot = "Correct the file on any computer, then restart the terminal; if the file is "
			"on a USB stick, just plug the stick in again. gopura-setup --check "
			"gopura.conf checks the file on a computer.",
	};

	for (unsigned i = 0; i < diagnostics->count; i++) {
		const struct diagnostic *found = diagnostics_get(diagnostics, i);

		marks[i][0] = '\0';
		if (found->line > 0)
			snprintf(marks[i], sizeof(marks[i]), "line %u", found->line);
		/* The mark shows the place. */
		items[i] = (struct notice_item){ .mark = marks[i],
						 .text = found->text + found->place_bytes };
	}
	snprintf(lead, sizeof(lead), "%s: the valid entries are in use.", provision->path);
	return draw_page(page, &notice);
}

static int draw_missing(struct setup_page *page, const struct options *options)
{
	char where[OPTIONS_CONFS_MAX * 256] = "Save it as ";
	const struct notice_item items[HINTS_MAX] = {
		{ "1", "On any computer, create a text file named gopura.conf:\n"
		       "[release]\n"
		       "url = https://museum.example/temple/\n"
		       "trust = 1.json" },
		{ "2", where },
		{ "3", "Restart the terminal; if you use a USB stick, just plug it in." },
	};
	const struct notice notice = {
		.title = "This terminal is not set up yet",
		.lead = "No release is configured, so there is nothing to show.",
		.items = items,
		.count = HINTS_MAX,
		.foot = "On the appliance, /efi is the partition GOPURA of its disk, and "
			"/run/gopura-stick is any USB stick. docs/terminal.md describes the other "
			"entries: language, panel, opening hours, network, Wi-Fi.",
	};

	for (uint32_t i = 0; i < options->conf_count; i++) {
		const size_t length = strlen(where);

		snprintf(where + length, sizeof(where) - length, "%s%.200s", i > 0 ? " or " : "",
			 options->conf_paths[i]);
	}
	snprintf(where + strlen(where), sizeof(where) - strlen(where),
		 ", and the release's root/1.json beside it as 1.json.");
	return draw_page(page, &notice);
}

int setup_page_show(struct setup_page *page, const struct options *options,
		    struct provision *provision, bool has_release)
{
	/* Nothing can be shown, and there is no trust root to check what may arrive. */
	const bool is_unset = options->conf_count > 0 && !options->trust_path && !has_release;

	if (is_unset && !provision->path)
		return draw_missing(page, options);
	if (is_unset && !provision->terminal.release_url[0] && provision->diagnostics.count == 0)
		diagnostics_add(&provision->diagnostics, -EINVAL, NULL, 0,
				"section [release] has no url and no trust; add the address of the "
				"release and its root/1.json");
	return provision->diagnostics.count > 0 ? draw_faults(page, provision) : 0;
}

void setup_page_finish(struct setup_page *page)
{
	bitmap_finish(&page->bitmap);
}

bool setup_page_covers(const struct setup_page *page)
{
	return page->bitmap.surface && page->leaves_ms == 0;
}

/* Returns in how many milliseconds the page is to fade out; -1: not by time, because the model
 * cannot be shown yet or the page was not drawn. */
static int64_t leaves_in_ms(const struct setup_page *page, bool pictured, int64_t now_ms)
{
	const int64_t due_ms = page->since_ms + PAGE_LEAST_MS;

	if (!pictured || page->since_ms == 0)
		return -1;
	return due_ms > now_ms ? due_ms - now_ms : 0;
}

static void draw_over(const struct setup_page *page, struct quads *quads, float alpha)
{
	const float w = (float)page->bitmap.width_px;
	const float h = (float)page->bitmap.height_px;
	const float corners[4][2] = { { 0, 0 }, { w, 0 }, { w, h }, { 0, h } };
	const float whole[4] = { 0, 0, 1, 1 };

	quads_draw(quads, PAGE_TEXTURE, corners, whole, alpha);
}

int setup_page_draw(struct setup_page *page, struct quads *quads, bool pictured, int64_t now_ms)
{
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
	if (page->leaves_ms == 0 && leaves_in_ms(page, pictured, now_ms) == 0)
		page->leaves_ms = now_ms;
	if (page->leaves_ms > 0) {
		alpha = 1 - (float)(now_ms - page->leaves_ms) / PAGE_FADE_MS;
		redraw_ask(page->redraw);
	}
	if (alpha <= 0) {
		quads_drop(quads, PAGE_TEXTURE);
		setup_page_finish(page);
		return 0;
	}
	quads_begin(quads, unmoved_px, page->viewport->panel_width_px,
		    page->viewport->panel_height_px, page->viewport->rotation_deg);
	rc = quads_upload(quads, &pixels);
	if (rc == 0)
		draw_over(page, quads, alpha);
	quads_end(quads);
	return rc;
}

int setup_page_wait_ms(const struct setup_page *page, bool pictured)
{
	return setup_page_covers(page) ? (int)leaves_in_ms(page, pictured, clock_now_ms()) : -1;
}
