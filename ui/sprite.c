/* Replaces the bitmaps of sprites and counts their revisions. */
#include "ui/sprite.h"

void sprites_init(struct sprite *sprites, uint32_t count, uint32_t *next_id)
{
	for (uint32_t i = 0; i < count; i++)
		sprites[i] = (struct sprite){ .id = (*next_id)++ };
}

void sprites_finish(struct sprite *sprites, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++)
		bitmap_finish(&sprites[i].bitmap);
}

cairo_t *sprite_begin(struct sprite *sprite, int width_px, int height_px)
{
	sprite->revision++;
	if (sprite->bitmap.width_px != width_px || sprite->bitmap.height_px != height_px) {
		bitmap_finish(&sprite->bitmap);
		if (bitmap_init(&sprite->bitmap, width_px, height_px) < 0)
			return NULL;
	}
	return bitmap_begin(&sprite->bitmap);
}

void sprite_end(struct sprite *sprite, cairo_t *context)
{
	bitmap_end(&sprite->bitmap, context);
}

void sprite_fill(struct sprite *sprite, struct colour colour)
{
	cairo_t *context = sprite_begin(sprite, 4, 4);

	if (!context)
		return;
	theme_set_source(context, colour, 1);
	cairo_paint(context);
	sprite_end(sprite, context);
}

void sprite_take(struct sprite *sprite, const struct bitmap *fresh, int rc)
{
	bitmap_finish(&sprite->bitmap);
	sprite->revision++;
	if (rc == 0)
		sprite->bitmap = *fresh;
}
