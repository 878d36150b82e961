/* The list of textured quads that a frame is made of. Views add theirs, bottom first. */
#ifndef GOPURA_UI_LAYERS_H
#define GOPURA_UI_LAYERS_H

#include "ui/rect.h"
#include "ui/sprite.h"

/* A textured quad. The app keeps one texture per bitmap id and uploads the pixels if revision
 * differs from its own. Draw in order, blending GL_ONE, GL_ONE_MINUS_SRC_ALPHA. */
struct overlay_layer {
	uint32_t bitmap;             /* id, below OVERLAY_BITMAPS_MAX */
	uint32_t revision;           /* never 0 */
	const struct bitmap *pixels; /* borrowed until the next overlay_update */
	float corners_px[4][2];      /* top left, top right, bottom right, bottom left */
	float source[4];             /* left, top, right, bottom of the bitmap, 0..1 */
	float alpha;                 /* multiplies all four channels */
};

struct layers {
	struct overlay_layer *list; /* borrowed; room for `most` */
	uint32_t count, most;
};

/* Each of these adds a sprite to the list, unless it is empty, alpha is 0 or the list is full. */

/* Returns the new layer, whose corners the caller sets, or NULL. Borrowed. */
struct overlay_layer *layers_add(struct layers *layers, const struct sprite *sprite, float alpha);
/* Stretches the sprite over a rectangle. */
void layers_add_stretched(struct layers *layers, const struct sprite *sprite, float alpha, float x,
			  float y, float width, float height);
/* At its own size, with its upper left corner at x, y. */
void layers_add_at(struct layers *layers, const struct sprite *sprite, float alpha, float x,
		   float y);
/* As wide as a window and clipped to it: top is where the sprite begins. Afterwards it is moved by
 * dx, dy. */
void layers_add_clipped(struct layers *layers, const struct sprite *sprite, float alpha,
			struct rect window, float top, float dx, float dy);
/* Centred on a point, with its height along a unit vector. */
void layers_add_turned(struct layers *layers, const struct sprite *sprite, float alpha,
		       const float at[2], const float along[2], float half_across,
		       float half_along);

/* For headless pictures and tests: draws every layer with Cairo over the contents of context. */
void layers_paint(const struct layers *layers, cairo_t *context);

#endif
