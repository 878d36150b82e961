/* The page that tells the exhibit engineer what is wrong with gopura.conf, or that the file is
 * missing. It stays for half a minute if a release can be shown then; otherwise until the terminal
 * is restarted. */
#ifndef GOPURA_APP_MODES_SETUP_PAGE_H
#define GOPURA_APP_MODES_SETUP_PAGE_H

#include "app/settings/options.h"
#include "app/settings/provision.h"
#include "app/view/redraw.h"
#include "app/view/viewport.h"
#include "render/display/quads.h"
#include "ui/bitmap.h"

struct setup_page {
	const struct viewport *viewport;
	struct redraw *redraw;
	struct bitmap bitmap; /* surface NULL: there is nothing to show */
	int64_t since_ms;     /* when it was first drawn; 0: not yet */
	int64_t leaves_ms;    /* when it began to fade out; 0: it stays */
};

/* viewport and redraw are borrowed for the page's life. */
void setup_page_init(struct setup_page *page, const struct viewport *viewport,
		     struct redraw *redraw);
/* Draws the page into its bitmap if there is something to say. has_release: the stored release can
 * be shown. May add a fault to *provision. Returns 0 or a negative errno. */
must_check int setup_page_show(struct setup_page *page, const struct options *options,
			       struct provision *provision, bool has_release);
/* Frees the bitmap; one that was never drawn is fine. */
void setup_page_finish(struct setup_page *page);
/* Draws the page over everything else in the frame, and fades it out when its time has passed.
 * pictured: the model was drawn, so it can be shown instead. Returns 0 or a negative errno. */
must_check int setup_page_draw(struct setup_page *page, struct quads *quads, bool pictured,
			       int64_t now_ms);
/* Returns whether the page is shown and not yet fading: touch has no effect then. */
bool setup_page_covers(const struct setup_page *page);
/* Returns in how many milliseconds it changes by itself; -1: not by time. */
int setup_page_wait_ms(const struct setup_page *page, bool pictured);

#endif
