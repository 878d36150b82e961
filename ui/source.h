/* How ui gets its pictures: a callback of the app, passed down to the code that draws. */
#ifndef GOPURA_UI_SOURCE_H
#define GOPURA_UI_SOURCE_H

#include <stdbool.h>

#include "format/picture.h"

/* What the app has of a picture. */
struct found_picture {
	const struct picture *picture; /* borrowed until the next call; NULL: not arrived yet */
	uint32_t width_px,
		height_px; /* size if known before it arrives, so that text does not jump; else 0 */
};

struct picture_source {
	/* Returns a picture by the name that a page or thumbnail gives ("pictures/gate.jpg").
	 * false: no picture has that name. Asking also requests it: it is fetched, and the app
	 * tells when it has arrived. */
	bool (*get)(void *data, const char *name, struct found_picture *out);
	void *data;
};

#endif
