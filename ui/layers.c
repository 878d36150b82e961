/* Computes the corners of textured quads, and paints a list of them with Cairo for tests. */
#include "ui/layers.h"

#include <math.h>
#include <string.h>

struct overlay_layer *layers_add(struct layers *layers, const struct sprite *sprite, float alpha)
{
	struct overlay_layer *layer;

	if (alpha <= 0 || !sprite->bitmap.surface || layers->count == layers->most)
		return NULL;
	layer = &layers->list[layers->count++];
	*layer = (struct overlay_layer){ .bitmap = sprite->id,
					 .revision = sprite->revision,
					 .pixels = &sprite->bitmap,
					 .source = { 0, 0, 1, 1 },
					 .alpha = alpha };
	return layer;
}

void layers_add_stretched(struct layers *layers, const struct sprite *sprite, float alpha, float x,
			  float y, float width, float height)
{
	struct overlay_layer *layer = layers_add(layers, sprite, alpha);
	const float corners[4][2] = {
		{ x, y }, { x + width, y }, { x + width, y + height }, { x, y + height }
	};

	if (layer)
		memcpy(layer->corners_px, corners, sizeof(corners));
}

void layers_add_at(struct layers *layers, const struct sprite *sprite, float alpha, float x,
		   float y)
{
	layers_add_stretched(layers, sprite, alpha, x, y, (float)sprite->bitmap.width_px,
			     (float)sprite->bitmap.height_px);
}

void layers_add_clipped(struct layers *layers, const struct sprite *sprite, float alpha,
			struct rect window, float top, float dx, float dy)
{
	float height = (float)sprite->bitmap.height_px;
	float top_in = fmaxf(top, (float)window.y_px);
	float bottom_in = fminf(top + height, (float)(window.y_px + window.height_px));
	struct overlay_layer *layer;

	if (bottom_in <= top_in)
		return;
	layer = layers_add(layers, sprite, alpha);
	if (!layer)
		return;
	layer->source[1] = (top_in - top) / height;
	layer->source[3] = (bottom_in - top) / height;
	for (int corner = 0; corner < 4; corner++) {
		bool right = corner == 1 || corner == 2;

		layer->corners_px[corner][0] =
			(float)window.x_px + (right ? (float)window.width_px : 0) + dx;
		layer->corners_px[corner][1] = (corner < 2 ? top_in : bottom_in) + dy;
	}
}

void layers_add_turned(struct layers *layers, const struct sprite *sprite, float alpha,
		       const float at[2], const float along[2], float half_across, float half_along)
{
	struct overlay_layer *layer = layers_add(layers, sprite, alpha);
	static const float sides[4][2] = { { -1, -1 }, { 1, -1 }, { 1, 1 }, { -1, 1 } };

	if (!layer)
		return;
	for (int corner = 0; corner < 4; corner++) {
		const float across = sides[corner][0] * half_across;
		const float down = sides[corner][1] * half_along;

		layer->corners_px[corner][0] = at[0] + across * along[1] - down * along[0];
		layer->corners_px[corner][1] = at[1] - across * along[0] - down * along[1];
	}
}

static void paint_layer(cairo_t *context, const struct overlay_layer *layer)
{
	float(*c)[2] = (float(*)[2])layer->corners_px;
	double width = (layer->source[2] - layer->source[0]) * layer->pixels->width_px;
	double height = (layer->source[3] - layer->source[1]) * layer->pixels->height_px;
	cairo_matrix_t matrix;

	cairo_save(context);
	cairo_move_to(context, c[0][0], c[0][1]);
	for (int i = 1; i < 4; i++)
		cairo_line_to(context, c[i][0], c[i][1]);
	cairo_close_path(context);
	cairo_clip(context);
	cairo_matrix_init(&matrix, (c[1][0] - c[0][0]) / width, (c[1][1] - c[0][1]) / width,
			  (c[3][0] - c[0][0]) / height, (c[3][1] - c[0][1]) / height, c[0][0],
			  c[0][1]);
	cairo_transform(context, &matrix);
	cairo_set_source_surface(context, layer->pixels->surface,
				 -layer->source[0] * layer->pixels->width_px,
				 -layer->source[1] * layer->pixels->height_px);
	cairo_pattern_set_extend(cairo_get_source(context), CAIRO_EXTEND_PAD);
	cairo_paint_with_alpha(context, layer->alpha);
	cairo_restore(context);
}

void layers_paint(const struct layers *layers, cairo_t *context)
{
	for (uint32_t i = 0; i < layers->count; i++)
		paint_layer(context, &layers->list[i]);
}
