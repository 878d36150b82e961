/* A bitmap that the app keeps as a texture: it has an id, and a revision that says when the texture
 * is out of date. */
#ifndef GOPURA_UI_SPRITE_H
#define GOPURA_UI_SPRITE_H

#include "ui/bitmap.h"
#include "ui/theme.h"

struct sprite {
	struct bitmap bitmap; /* empty: not drawn yet, or memory ran out; it is left out */
	uint32_t id;          /* the texture's */
	uint32_t revision;    /* raised by every drawing; never 0 after the first */
};

/* Gives empty sprites their ids: *next_id and the following. *next_id is advanced. */
void sprites_init(struct sprite *sprites, uint32_t count, uint32_t *next_id);
/* Frees their bitmaps. Zeroed sprites are fine. */
void sprites_finish(struct sprite *sprites, uint32_t count);

/* Prepares a bitmap of that size for drawing. Returns NULL if memory runs out; else end with
 * sprite_end. */
cairo_t *sprite_begin(struct sprite *sprite, int width_px, int height_px);
/* Ends a drawing. context is what sprite_begin returned. */
void sprite_end(struct sprite *sprite, cairo_t *context);
/* Makes it a few pixels of one colour, to be stretched. */
void sprite_fill(struct sprite *sprite, struct colour colour);
/* Takes over a bitmap that another module drew. rc is that module's result: if it is negative, the
 * sprite is empty. */
void sprite_take(struct sprite *sprite, const struct bitmap *fresh, int rc);

#endif
