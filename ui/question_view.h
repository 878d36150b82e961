/* The question whether somebody is still there, with the seconds left for an answer. It stands over
 * everything else in the middle of the panel: nothing else matters then. In reach mode it is low.
 */
#ifndef GOPURA_UI_QUESTION_VIEW_H
#define GOPURA_UI_QUESTION_VIEW_H

#include "ui/fade.h"
#include "ui/layers.h"
#include "ui/screen.h"

struct question_view {
	struct fade fade; /* on: it asks */
	int seconds_left;
	bool dirty; /* seconds, texts or sizes changed: draw it again when it asks */
	struct sprite sprite;
};

void question_view_init(struct question_view *view, uint32_t *next_id);
void question_view_finish(struct question_view *view);

/* Asks; -1: does not ask. */
void question_view_ask(struct question_view *view, int seconds_left);
/* Returns its place. Its size is that of its last drawing. */
struct rect question_view_rect(const struct question_view *view, const struct screen *screen);
/* Draws what changed and advances by step_ms. Returns true if something still moves. */
bool question_view_update(struct question_view *view, const struct screen *screen, int64_t step_ms);
void question_view_layers(const struct question_view *view, const struct screen *screen,
			  struct layers *layers);

#endif
