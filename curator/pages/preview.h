/* Pictures of what a visitor will see of a part, drawn by the terminal's own code: ui/ over the
 * model, from an information database that pipeline/content makes in memory. */
#ifndef GOPURA_CURATOR_PAGES_PREVIEW_H
#define GOPURA_CURATOR_PAGES_PREVIEW_H

#include "curator/session/site.h"

enum preview_kind {
	PREVIEW_NEAR, /* names beside the model */
	PREVIEW_CARD, /* the part was touched */
	PREVIEW_PAGE, /* its page is open */
};

enum { PREVIEW_WIDTH_PX = 1280, PREVIEW_HEIGHT_PX = 720 };

struct preview;

/* All borrowed. */
struct preview_wish {
	enum preview_kind kind;
	const char *part, *language;
	const char *html; /* of the page in that language, instead of the saved one; NULL: none */
};

/* site is borrowed for the lifetime of *out, which the caller owns; NULL on failure. -ENOMEM. */
must_check int preview_create(struct preview **out, struct site *site);
void preview_destroy(struct preview *preview); /* NULL is fine */

/* Appends a JPEG. Any thread; each call waits for the one before. -EINVAL: the content has faults,
 * so a release of it has no picture. -ENOENT: no such part, or it has no page. With a diagnostic.
 */
must_check int preview_draw(struct preview *preview, const struct preview_wish *wish,
			    struct buffer *out, struct diagnostics *diagnostics);

#endif
