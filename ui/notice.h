/* A page for the exhibit engineer over the whole panel: what is wrong and what mends it, readable
 * from where one stands with a keyboard. The type is as large as all of it allows; what does not
 * fit at its smallest is counted. */
#ifndef GOPURA_UI_NOTICE_H
#define GOPURA_UI_NOTICE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/compiler.h"
#include "ui/bitmap.h"

/* UTF-8, borrowed for the call. */
struct notice_item {
	const char *mark; /* before it, such as "line 7"; "": none */
	const char *text;
};

struct notice {
	const char *title, *lead; /* what happened, and where */
	const struct notice_item *items;
	uint32_t count;
	uint32_t dropped; /* more there would be */
	const char *foot; /* what to do then */
};

/* A fresh bitmap of that size, opaque. px_per_mm of the panel; 0: not known. *shown, or
 * NULL, is how many of the items found room. -EINVAL, -ENOMEM as bitmap_init. */
must_check int notice_draw(struct bitmap *out, const struct notice *notice, float px_per_mm,
			   int width_px, int height_px, uint32_t *shown);

#endif
