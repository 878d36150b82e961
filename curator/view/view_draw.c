/* The rasteriser draws squares: a view is the middle rows or columns of one. */
#include "curator/view/view_draw.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/vec.h"
#include "pipeline/samples/raster.h"

struct view_draw {
	uint32_t width_px, height_px, side_px, left, top; /* where the view is in the square */
	struct raster *raster;                            /* owned, as all below */
	uint8_t (*colours)[3];
	int8_t (*normals)[3];
	uint8_t *open;
	float *inverse_m;
	uint32_t *pieces, piece_room;
	struct distance *order;
};

/* Pieces are drawn from near to far, so that what is hidden is not decoded. */
struct distance {
	float m;
	uint32_t piece;
};

int view_draw_create(struct view_draw **out, uint32_t width_px, uint32_t height_px)
{
	struct view_draw *draw = calloc(1, sizeof(*draw));
	const uint32_t longest = width_px > height_px ? width_px : height_px;
	const size_t pixels = (size_t)width_px * height_px;
	int rc;

	*out = NULL;
	if (!draw)
		return -ENOMEM;
	draw->width_px = width_px;
	draw->height_px = height_px;
	draw->side_px = (longest + RASTER_BLOCK_PX - 1) / RASTER_BLOCK_PX * RASTER_BLOCK_PX;
	draw->left = (draw->side_px - width_px) / 2;
	draw->top = (draw->side_px - height_px) / 2;
	draw->colours = malloc(pixels * sizeof(*draw->colours));
	draw->normals = malloc(pixels * sizeof(*draw->normals));
	draw->open = malloc(pixels);
	draw->inverse_m = malloc(pixels * sizeof(*draw->inverse_m));
	rc = raster_create(&draw->raster, draw->side_px, true);
	if (rc < 0 || !draw->colours || !draw->normals || !draw->open || !draw->inverse_m) {
		view_draw_destroy(draw);
		return -ENOMEM;
	}
	*out = draw;
	return 0;
}

void view_draw_destroy(struct view_draw *draw)
{
	if (!draw)
		return;
	raster_destroy(draw->raster);
	free(draw->colours);
	free(draw->normals);
	free(draw->open);
	free(draw->inverse_m);
	free(draw->pieces);
	free(draw->order);
	free(draw);
}

static int by_distance(const void *a, const void *b)
{
	const struct distance *left = a, *right = b;

	if (left->m != right->m)
		return left->m < right->m ? -1 : 1;
	return (left->piece > right->piece) - (left->piece < right->piece);
}

static int make_room(struct view_draw *draw, uint32_t count)
{
	if (count <= draw->piece_room)
		return 0;
	free(draw->pieces);
	free(draw->order);
	draw->pieces = malloc(count * sizeof(*draw->pieces));
	draw->order = malloc(count * sizeof(*draw->order));
	draw->piece_room = draw->pieces && draw->order ? count : 0;
	return draw->piece_room ? 0 : -ENOMEM;
}

/* Of the nearest point of a box. */
static float distance_to_box(const struct model_piece *piece, const float eye_m[3])
{
	float sum = 0;

	for (int i = 0; i < 3; i++) {
		const float away = vec_most(
			0, vec_most(piece->low_m[i] - eye_m[i], eye_m[i] - piece->high_m[i]));
		sum += away * away;
	}
	return sqrtf(sum);
}

static int draw_pieces(struct view_draw *draw, struct model *model, const struct camera *square,
		       float detail_px)
{
	uint32_t count;
	int rc = make_room(draw, model->piece_count);

	if (rc < 0)
		return rc;
	count = model_choose(model, square->eye_m, detail_px / camera_px_per_radian(square),
			     draw->pieces);
	for (uint32_t n = 0; n < count; n++) {
		draw->order[n].piece = draw->pieces[n];
		draw->order[n].m = distance_to_box(&model->pieces[draw->pieces[n]], square->eye_m);
	}
	qsort(draw->order, count, sizeof(*draw->order), by_distance);
	raster_begin(draw->raster, square);
	for (uint32_t n = 0; n < count; n++) {
		const uint32_t piece = draw->order[n].piece;
		const struct model_piece *its = &model->pieces[piece];
		struct model_mesh mesh;

		if (raster_hides(draw->raster, its->low_m, its->high_m))
			continue;
		rc = model_load(model, piece, &mesh);
		if (rc < 0)
			return rc;
		raster_draw(draw->raster, &mesh);
	}
	return 0;
}

/* ---- out of the blocks */

static void copy_sample(struct view_draw *draw, const struct raster_block *block, uint32_t sample,
			uint32_t at)
{
	const uint32_t surface = block->surface[sample], colour = block->colour[sample],
		       sky = surface >> 24;
	float normal[3];

	draw->inverse_m[at] = block->inverse_m[sample];
	draw->open[at] = (uint8_t)(sky >= 128 ? (sky - 128) * 255 / 127 : (sky - 1) * 255 / 126);
	for (int i = 0; i < 3; i++) {
		normal[i] = (float)(surface >> 8 * i & 0xff) / 127.5f - 1;
		draw->colours[at][i] = (uint8_t)(colour >> 8 * i);
	}
	vec_normalise(normal);
	for (int i = 0; i < 3; i++)
		draw->normals[at][i] = (int8_t)lrintf(127 * normal[i]);
}

static void copy_block(struct view_draw *draw, uint32_t column, uint32_t row)
{
	struct raster_block block;

	if (!raster_get_block(draw->raster, column, row, &block))
		return;
	for (uint32_t sample = 0; sample < RASTER_BLOCK_SAMPLES; sample++) {
		/* Unsigned numbers wrap: what is left of the view is beyond its right edge. */
		const uint32_t x = RASTER_BLOCK_PX * column + sample % RASTER_BLOCK_PX - draw->left,
			       y = RASTER_BLOCK_PX * row + sample / RASTER_BLOCK_PX - draw->top;

		if (x < draw->width_px && y < draw->height_px && block.inverse_m[sample] > 0)
			copy_sample(draw, &block, sample, y * draw->width_px + x);
	}
}

int view_draw_image(struct view_draw *draw, struct model *model, const struct camera *camera,
		    float detail_px, struct view_image *out)
{
	const float half = tanf(camera->fov_deg * (float)M_PI / 360);
	const uint32_t blocks = draw->side_px / RASTER_BLOCK_PX;
	const size_t pixels = (size_t)draw->width_px * draw->height_px;
	struct camera square = *camera;
	int rc;

	square.width_px = square.height_px = (int)draw->side_px;
	square.fov_deg =
		atanf(half * (float)draw->side_px / (float)draw->height_px) * 360 / (float)M_PI;
	rc = draw_pieces(draw, model, &square, detail_px);
	if (rc < 0)
		return rc;
	memset(draw->inverse_m, 0, pixels * sizeof(*draw->inverse_m));
	memset(draw->colours, 0, pixels * sizeof(*draw->colours));
	memset(draw->normals, 0, pixels * sizeof(*draw->normals));
	memset(draw->open, 0, pixels);
	for (uint32_t row = 0; row < blocks; row++)
		for (uint32_t column = 0; column < blocks; column++)
			copy_block(draw, column, row);
	*out = (struct view_image){ .width_px = draw->width_px,
				    .height_px = draw->height_px,
				    .px_per_radian = camera_px_per_radian(camera),
				    .colours = draw->colours,
				    .normals = draw->normals,
				    .open = draw->open,
				    .inverse_m = draw->inverse_m };
	return 0;
}
