/* A full-panel page for the exhibit engineer: what is wrong and how to repair it, readable from a
 * keyboard's distance. The type is as large as the content allows. Items that do not fit even at
 * the smallest size are only counted. */
#ifndef GOPURA_UI_NOTICE_H
#define GOPURA_UI_NOTICE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/compiler.h"
#include "ui/bitmap.h"

/* UTF-8, borrowed for the call. */
struct notice_item {
	const char *mark; /* in front of the text, such as "line 7"; "": none */
	const char *text;
};

struct notice {
	const char *title, *lead; /* what happened, and where */
	const struct notice_item *items;
	uint32_t count;
	uint32_t dropped; /* how many further items were not passed */
	const char *foot; /* what to do afterwards */
};

/* Draws the notice into a new opaque bitmap of that size, owned by the caller. px_per_mm is the
 * panel's; 0: unknown. *shown (may be NULL) is set to the number of items that fit. Returns -EINVAL
 * or -ENOMEM as bitmap_init does. */
must_check int notice_draw(struct bitmap *out, const struct notice *notice, float px_per_mm,
			   int width_px, int height_px, uint32_t *shown);

#endif
