/* The rasteriser draws squares: a view is the middle rows or columns of one. */
#include "curator/view/view_draw.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/parallel.h"
#include "geometry/vec.h"
#include "pipeline/samples/raster.h"
#include "pipeline/samples/sight.h"

/* Pieces are drawn so many at a time: while they are loaded one after the other, nothing draws, and
 * those of a batch do not hide each other. */
enum { BATCH_PIECES = 128, ROWS_AT_ONCE = 8 };

/* Copies of the triangles of pieces, since a model lends those of one piece at a time. */
struct batch {
	struct model_mesh meshes[BATCH_PIECES]; /* vertices and indices are set when it is drawn */
	uint32_t count;
	struct model_vertex *vertices; /* owned; as the next, of one mesh after the other */
	uint16_t *indices;
	uint32_t vertex_count, vertex_room, index_count, index_room;
};

struct view_draw {
	struct model *model;                              /* borrowed */
	uint32_t width_px, height_px, side_px, left, top; /* where the view is in the square */
	uint32_t threads;
	struct batch batch;
	struct raster *raster; /* owned, as all below */
	uint8_t (*colours)[3];
	int8_t (*normals)[3];
	uint8_t *open;
	float *inverse_m;
	struct sight *sight;
};

int view_draw_create(struct view_draw **out, struct model *model, uint32_t width_px,
		     uint32_t height_px)
{
	struct view_draw *draw = calloc(1, sizeof(*draw));
	const uint32_t longest = width_px > height_px ? width_px : height_px;
	const size_t pixels = (size_t)width_px * height_px;
	int rc;

	*out = NULL;
	if (!draw)
		return -ENOMEM;
	draw->model = model;
	draw->width_px = width_px;
	draw->height_px = height_px;
	draw->side_px = (longest + RASTER_BLOCK_PX - 1) / RASTER_BLOCK_PX * RASTER_BLOCK_PX;
	draw->left = (draw->side_px - width_px) / 2;
	draw->top = (draw->side_px - height_px) / 2;
	draw->colours = malloc(pixels * sizeof(*draw->colours));
	draw->normals = malloc(pixels * sizeof(*draw->normals));
	draw->open = malloc(pixels);
	draw->inverse_m = malloc(pixels * sizeof(*draw->inverse_m));
	draw->threads = parallel_cores() > 1 ? 2 : 1;
	rc = raster_create(&draw->raster, draw->side_px, true);
	if (rc == 0)
		rc = sight_create(&draw->sight, model);
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
	sight_destroy(draw->sight);
	free(draw->batch.vertices);
	free(draw->batch.indices);
	free(draw);
}

/* ---- pieces, a batch at a time */

static int add_to_batch(struct batch *batch, const struct model_mesh *mesh)
{
	int rc = ARRAY_RESERVE(batch->vertices, batch->vertex_room,
			       (uint64_t)batch->vertex_count + mesh->vertex_count, UINT32_MAX);

	if (rc == 0)
		rc = ARRAY_RESERVE(batch->indices, batch->index_room,
				   (uint64_t)batch->index_count + mesh->index_count, UINT32_MAX);
	if (rc < 0)
		return rc;
	memcpy(batch->vertices + batch->vertex_count, mesh->vertices,
	       mesh->vertex_count * sizeof(*mesh->vertices));
	memcpy(batch->indices + batch->index_count, mesh->indices,
	       mesh->index_count * sizeof(*mesh->indices));
	batch->vertex_count += mesh->vertex_count;
	batch->index_count += mesh->index_count;
	batch->meshes[batch->count++] = (struct model_mesh){ .vertex_count = mesh->vertex_count,
							     .index_count = mesh->index_count };
	return 0;
}

static int draw_batch(struct view_draw *draw)
{
	struct batch *batch = &draw->batch;
	const struct model_vertex *vertices = batch->vertices;
	const uint16_t *indices = batch->indices;
	int rc;

	for (uint32_t i = 0; i < batch->count; i++) {
		batch->meshes[i].vertices = vertices;
		batch->meshes[i].indices = indices;
		vertices += batch->meshes[i].vertex_count;
		indices += batch->meshes[i].index_count;
	}
	rc = raster_draw_meshes(draw->raster, batch->meshes, batch->count, draw->threads);
	batch->count = batch->vertex_count = batch->index_count = 0;
	return rc;
}

/* What the view shows, which is less than the square. From near to far, so that what is hidden is
 * not decoded. */
static int draw_pieces(struct view_draw *draw, const struct camera *view,
		       const struct camera *square, float detail_px)
{
	const uint32_t *pieces;
	uint32_t count;
	float matrix[16];
	int rc = 0;

	camera_matrix(view, matrix);
	sight_look(draw->sight, square->eye_m, detail_px / camera_px_per_radian(square));
	pieces = sight_visible(draw->sight, matrix, square->eye_m, &count);
	raster_begin(draw->raster, square);
	draw->batch.count = draw->batch.vertex_count = draw->batch.index_count = 0;
	for (uint32_t n = 0; n < count && rc == 0; n++) {
		const struct model_piece *piece = &draw->model->pieces[pieces[n]];
		struct model_mesh mesh;

		if (raster_hides(draw->raster, piece->low_m, piece->high_m))
			continue;
		rc = model_load(draw->model, pieces[n], &mesh);
		if (rc == 0)
			rc = add_to_batch(&draw->batch, &mesh);
		if (rc == 0 && draw->batch.count == BATCH_PIECES)
			rc = draw_batch(draw);
	}
	return rc == 0 ? draw_batch(draw) : rc;
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

static int copy_rows(void *user, uint32_t first, uint32_t after, uint32_t worker)
{
	struct view_draw *draw = user;

	(void)worker;
	for (uint32_t row = first; row < after; row++)
		for (uint32_t column = 0; column < draw->side_px / RASTER_BLOCK_PX; column++)
			copy_block(draw, column, row);
	return 0;
}

int view_draw_image(struct view_draw *draw, const struct camera *camera, float detail_px,
		    struct view_image *out)
{
	const float half = tanf(camera->fov_deg * (float)M_PI / 360);
	const uint32_t blocks = draw->side_px / RASTER_BLOCK_PX;
	const size_t pixels = (size_t)draw->width_px * draw->height_px;
	struct camera square = *camera;
	int rc;

	square.width_px = square.height_px = (int)draw->side_px;
	square.fov_deg =
		atanf(half * (float)draw->side_px / (float)draw->height_px) * 360 / (float)M_PI;
	rc = draw_pieces(draw, camera, &square, detail_px);
	if (rc < 0)
		return rc;
	memset(draw->inverse_m, 0, pixels * sizeof(*draw->inverse_m));
	memset(draw->colours, 0, pixels * sizeof(*draw->colours));
	memset(draw->normals, 0, pixels * sizeof(*draw->normals));
	memset(draw->open, 0, pixels);
	rc = parallel_ranges(draw->threads, blocks, ROWS_AT_ONCE, copy_rows, draw);
	if (rc < 0)
		return rc;
	*out = (struct view_image){ .width_px = draw->width_px,
				    .height_px = draw->height_px,
				    .px_per_radian = camera_px_per_radian(camera),
				    .colours = draw->colours,
				    .normals = draw->normals,
				    .open = draw->open,
				    .inverse_m = draw->inverse_m };
	return 0;
}
