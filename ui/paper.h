/* The paper beside the model that a page or the search stands on: its head with the control that
 * closes, how it slides in, and the mark that says how far it is scrolled. */
#ifndef GOPURA_UI_PAPER_H
#define GOPURA_UI_PAPER_H

#include "ui/fade.h"
#include "ui/layers.h"
#include "ui/screen.h"

struct paper {
	struct sprite ground, mark;
};

/* Draws the sprites once; they never change. */
void paper_init(struct paper *paper, const struct theme *theme, uint32_t *next_id);
void paper_finish(struct paper *paper);

/* The head of a paper with that place: the line with the control that closes it. On a flat panel it
 * is in the lowest line, beside the bar; else on top of the paper. */
struct rect paper_head(const struct screen *screen, struct rect all);
/* The control that closes, at the end of the head. */
struct rect paper_close(const struct screen *screen, struct rect head);

/* Draws an empty head with its line and the control that closes, at the origin. */
void paper_draw_head(cairo_t *context, const struct screen *screen, struct rect head);

/* How far a paper is from its place while it slides in, and its alpha. */
struct paper_slide {
	float alpha, dx_px, dy_px;
};
struct paper_slide paper_slide(const struct screen *screen, const struct fade *fade);
/* Adds the ground of a paper. */
void paper_add_ground(const struct paper *paper, struct layers *layers, struct paper_slide slide,
		      struct rect all);
/* Adds a sprite at a place on the paper, at its own size. */
void paper_add_at(struct layers *layers, const struct sprite *sprite, struct paper_slide slide,
		  struct rect at);
/* Adds the mark of a window that is scrolled to scroll_px of most_px; none if most_px is 0. */
void paper_add_mark(const struct paper *paper, struct layers *layers, struct paper_slide slide,
		    struct rect window, float scroll_px, int most_px);

#endif
