/* Where ui gets its pictures: a callback of the app's, handed down to whoever draws. */
#ifndef GOPURA_UI_SOURCE_H
#define GOPURA_UI_SOURCE_H

#include <stdbool.h>

#include "format/picture.h"

struct overlay_picture {
	const struct picture *picture; /* borrowed until the next call; NULL: not here yet */
	uint32_t width_px, height_px; /* when known before it arrives, so that text does not jump */
};

struct picture_source {
	/* A picture by the name that a page or thumbnail gives ("pictures/gate.jpg"). false: there
	 * is none of that name. Asking is wanting: it is fetched, and the app says when it came. */
	bool (*get)(void *data, const char *name, struct overlay_picture *out);
	void *data;
};

#endif
