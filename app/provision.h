/* What gopura.conf says of this terminal, under what the command line says; and the page on the
 * panel that tells the exhibit engineer what is wrong with it. The page stays for half a minute
 * where there is a release to be shown then, else until the terminal is started anew. */
#ifndef GOPURA_APP_PROVISION_H
#define GOPURA_APP_PROVISION_H

#include <limits.h>
#include <stdbool.h>
#include <stdint.h>

#include "app/options.h"
#include "board/profile.h"
#include "board/terminal.h"
#include "ui/bitmap.h"

struct kiosk;

struct provision {
	struct terminal terminal; /* terminal_default where there is no file */
	struct faults faults;
	const char *path; /* the file that was read; NULL: none was there, or none asked for */
	char trust_path[PATH_MAX], ca_path[PATH_MAX], board_path[PATH_MAX];
	struct bitmap page;     /* no surface: nothing is to be said */
	int64_t page_since_ms;  /* when it came onto the panel; 0: not yet */
	int64_t page_leaves_ms; /* when it began to go; 0: it stays */
};

/* provision is zeroed. Fills in the options that the command line leaves open, and the profile;
 * logs the faults. What it fills in is borrowed from provision. Negative errno (logged): the
 * profile of --board does not do, and holds what is right of it. */
must_check int provision_read(struct provision *provision, struct options *options,
			      struct profile *profile);
/* Draws the page, if there is something to say. Needs the panel's size, and whether a release is
 * remembered. */
must_check int provision_show(struct kiosk *kiosk);
void provision_finish(struct provision *provision); /* zeroed is fine */

/* Over everything else that is in the frame. */
must_check int provision_draw(struct kiosk *kiosk, int64_t now_ms);
/* The page is up: touch means nothing. */
bool provision_covers(const struct kiosk *kiosk);
/* In how many milliseconds the page changes by itself; -1: not by time. */
int provision_wait_ms(const struct kiosk *kiosk);

#endif
