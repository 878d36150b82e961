/* The words of a spoken text while it is heard, and how far it is: a dark strip at the foot of the
 * page. */
#ifndef GOPURA_UI_SPOKEN_VIEW_H
#define GOPURA_UI_SPOKEN_VIEW_H

#include "ui/fade.h"
#include "ui/layers.h"
#include "ui/overlay_data.h"
#include "ui/screen.h"

enum { SPOKEN_WORDS_BYTES = 512 };

struct spoken_view {
	struct fade fade; /* on: something is spoken */
	bool dirty;
	float share; /* of the text that was heard */
	char words[SPOKEN_WORDS_BYTES];
	struct sprite box, bar;
};

void spoken_view_init(struct spoken_view *view, uint32_t *next_id);
void spoken_view_finish(struct spoken_view *view);

/* Sets what is spoken; copied. NULL: nothing. */
void spoken_view_set(struct spoken_view *view, const struct overlay_spoken *spoken);
/* Draws what changed and advances by step_ms. window: what the page shows of its article. Returns
 * true if something still moves. */
bool spoken_view_update(struct spoken_view *view, const struct screen *screen, struct rect window,
			int64_t step_ms);
void spoken_view_layers(const struct spoken_view *view, const struct screen *screen,
			struct rect window, struct layers *layers);

#endif
