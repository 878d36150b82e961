/* The pictures of pages for a preview: decoded from the content folder when they are asked for. */
#ifndef GOPURA_CURATOR_PAGES_PREVIEW_PICTURES_H
#define GOPURA_CURATOR_PAGES_PREVIEW_PICTURES_H

#include "pipeline/content/content.h"
#include "ui/source.h"

enum { PREVIEW_PICTURES_MAX = 65 }; /* a page's, and the thumbnail */

struct preview_pictures {
	const struct content *content; /* borrowed */
	char names[PREVIEW_PICTURES_MAX][256];
	struct picture pictures[PREVIEW_PICTURES_MAX]; /* owned */
	uint32_t count;
};

/* content is borrowed. */
void preview_pictures_init(struct preview_pictures *pictures, const struct content *content);
void preview_pictures_finish(struct preview_pictures *pictures);

/* For struct overlay_options; data is the struct. */
bool preview_pictures_get(void *data, const char *name, struct found_picture *out);

#endif
