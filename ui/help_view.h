/* The help: how to touch the model, as moving pictures and words. One finger moves to and fro, two
 * move apart, a name is tapped. The pictures are understandable without the words. */
#ifndef GOPURA_UI_HELP_VIEW_H
#define GOPURA_UI_HELP_VIEW_H

#include "ui/fade.h"
#include "ui/layers.h"
#include "ui/screen.h"

enum {
	HELP_FINGERS = 3,     /* one turns, two zoom */
	HELP_MOVES_MS = 6000, /* then they stop, and no more frames are drawn for them */
	HELP_NEW_MS = 500,    /* a tap that began before the help came takes at most so long */
};

struct help_view {
	struct fade fade; /* on: it is open; it is at first */
	int64_t shown_ms; /* how long its fingers have moved */
	bool dirty;       /* texts or sizes changed: draw it again */
	struct sprite sprite, finger;
};

void help_view_init(struct help_view *view, const struct theme *theme, uint32_t *next_id);
void help_view_finish(struct help_view *view);

/* Opens or closes it. Returns true if that changes anything. */
bool help_view_show(struct help_view *view, bool on);
/* Returns its place. Its size is that of its last drawing. */
struct rect help_view_rect(const struct help_view *view, const struct screen *screen);
/* Sets the centres of the fingers on a help of that width, shown_ms after it appeared. */
void help_view_fingers(const struct theme *theme, int width_px, bool has_names, int64_t shown_ms,
		       float middles_px[HELP_FINGERS][2]);
/* Draws what changed and advances by step_ms. has_names: the model has names to tap, and the help
 * explains them. Returns true if something still moves. */
bool help_view_update(struct help_view *view, const struct screen *screen, bool has_names,
		      int64_t step_ms);
void help_view_layers(const struct help_view *view, const struct screen *screen, bool has_names,
		      struct layers *layers);

#endif
