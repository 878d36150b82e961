/* Draws range images from around the model and looks each vertex up in them. */
#include "pipeline/texmesh/vertex_scales.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/camera.h"
#include "geometry/vec.h"
#include "pipeline/samples/chunks.h"
#include "pipeline/samples/raster.h"
#include "pipeline/samples/scale_space.h"

enum { SIDE_PX = 512, VIEWS = 14 };

static const float fov_deg = 30;

/* A vertex is seen if it is at the depth of its pixel, or nearer, but for this share. */
static const float depth_share = 0.005f;

/* Cosine: of what is seen more aslant, a silhouette would be a feature of a ball. */
static const float facing_least = 0.6f;

static const struct scale_space_options scale_options = { VERTEX_SCALES, { 1, 2, 4, 8 }, 0.001f };

struct looker {
	struct model *model;
	struct raster *raster;
	uint32_t *pieces;
	/* The range image, of which only the rectangle that shows something is kept. */
	float *inverse_m;
	uint32_t left, top, width, height;
};

/* The six sides and the eight corners of a cube. */
static void place_camera(struct camera *out, const struct model *model, int view)
{
	float middle[3], way[3] = { 0, 0, 0 };
	float radius = vec_distance(model->low_m, model->high_m) / 2, away;

	if (view < 6) {
		way[view / 2] = view % 2 ? 1 : -1;
	} else {
		for (int k = 0; k < 3; k++)
			way[k] = (view - 6) >> k & 1 ? 1 : -1;
		vec_normalise(way);
	}
	radius = radius > 0 ? radius : 1;
	away = 1.02f * radius / sinf(fov_deg / 2 * (float)M_PI / 180);
	vec_mix(middle, model->low_m, model->high_m, 0.5f);
	*out = (struct camera){ .up = { 0, 0, 1 },
				.fov_deg = fov_deg,
				.near_m = away / 100,
				.far_m = 2 * away,
				.width_px = SIDE_PX,
				.height_px = SIDE_PX };
	vec_copy(out->target_m, middle);
	vec_copy(out->eye_m, middle);
	vec_add_scaled(out->eye_m, out->eye_m, away, way);
}

/* Returns the numbers of eight pixels of the raster; NULL if none shows anything. */
static const float *row_of_block(const struct looker *looker, uint32_t x, uint32_t y)
{
	struct raster_block block;

	if (!raster_get_block(looker->raster, x / RASTER_BLOCK_PX, y / RASTER_BLOCK_PX, &block))
		return NULL;
	return &block.inverse_m[y % RASTER_BLOCK_PX * RASTER_BLOCK_PX];
}

/* Copies the rectangle of blocks that show something. */
static void keep_seen(struct looker *looker)
{
	uint32_t right = 0, bottom = 0;

	looker->left = looker->top = SIDE_PX;
	for (uint32_t y = 0; y < SIDE_PX; y += RASTER_BLOCK_PX)
		for (uint32_t x = 0; x < SIDE_PX; x += RASTER_BLOCK_PX) {
			if (!row_of_block(looker, x, y))
				continue;
			looker->left = x < looker->left ? x : looker->left;
			looker->top = y < looker->top ? y : looker->top;
			right = x + RASTER_BLOCK_PX > right ? x + RASTER_BLOCK_PX : right;
			bottom = y + RASTER_BLOCK_PX > bottom ? y + RASTER_BLOCK_PX : bottom;
		}
	looker->width = right > looker->left ? right - looker->left : 0;
	looker->height = bottom > looker->top ? bottom - looker->top : 0;
	for (uint32_t y = 0; y < looker->height; y++)
		for (uint32_t x = 0; x < looker->width; x += RASTER_BLOCK_PX) {
			const float *from = row_of_block(looker, looker->left + x, looker->top + y);
			float *to = &looker->inverse_m[y * looker->width + x];

			if (from)
				memcpy(to, from, RASTER_BLOCK_PX * sizeof(*to));
			else
				memset(to, 0, RASTER_BLOCK_PX * sizeof(*to));
		}
}

static int draw(struct looker *looker, const struct camera *camera)
{
	const uint32_t count = model_choose(looker->model, camera->eye_m, 0, looker->pieces);

	raster_begin(looker->raster, camera);
	for (uint32_t i = 0; i < count; i++) {
		struct model_mesh mesh;
		int rc = model_load(looker->model, looker->pieces[i], &mesh);

		if (rc < 0)
			return rc;
		raster_draw(looker->raster, &mesh);
	}
	keep_seen(looker);
	return 0;
}

/* The last scale of the pixels around one: a crossing is a line one pixel wide, and a vertex is
 * nowhere exactly on it. */
static uint8_t scale_around(const struct scale_map *map, uint32_t x, uint32_t y)
{
	uint8_t most = 0;

	for (uint32_t v = y > 0 ? y - 1 : 0; v <= y + 1 && v < map->height_px; v++)
		for (uint32_t u = x > 0 ? x - 1 : 0; u <= x + 1 && u < map->width_px; u++)
			if (map->scales[v * map->width_px + u] > most)
				most = map->scales[v * map->width_px + u];
	return most;
}

static void look_up(uint8_t *out, const struct reduced_mesh *copy, const struct looker *looker,
		    const struct scale_map *map, const struct camera *camera)
{
	const float px = camera_px_per_radian(camera);
	float axes[16];

	camera_view(camera, axes);
	for (uint32_t i = 0; i < copy->vertex_count; i++) {
		const float *p = copy->positions[i];
		float at[3];

		for (int k = 0; k < 3; k++)
			at[k] = axes[k] * p[0] + axes[4 + k] * p[1] + axes[8 + k] * p[2] +
				axes[12 + k];
		const float x = SIDE_PX / 2 - px * at[0] / at[2] - (float)looker->left;
		const float y = SIDE_PX / 2 + px * at[1] / at[2] - (float)looker->top;
		if (at[2] >= 0 ||
		    !(x >= 0 && y >= 0 && x < (float)looker->width && y < (float)looker->height))
			continue;
		float towards[3];

		vec_sub(towards, camera->eye_m, p);
		vec_normalise(towards);
		if (vec_dot(copy->normals[i], towards) < facing_least)
			continue;
		const uint32_t column = (uint32_t)x, row = (uint32_t)y;
		if (-at[2] * looker->inverse_m[row * looker->width + column] > 1 + depth_share)
			continue;
		const uint8_t scale = scale_around(map, column, row);
		out[i] = scale > out[i] ? scale : out[i];
	}
}

static int look(uint8_t *out, const struct reduced_mesh *copy, struct looker *looker)
{
	for (int view = 0; view < VIEWS; view++) {
		struct scale_map map;
		struct camera camera;
		int rc;

		place_camera(&camera, looker->model, view);
		rc = draw(looker, &camera);
		if (rc == 0 && looker->width == 0)
			continue;
		const struct range_image image = { looker->width, looker->height,
						   looker->inverse_m };
		if (rc == 0)
			rc = scale_map_make(&map, &image, &scale_options);
		if (rc < 0)
			return rc;
		look_up(out, copy, looker, &map, &camera);
		scale_map_finish(&map);
	}
	return 0;
}

int vertex_scales_find(uint8_t *out, const struct reduced_mesh *copy, const struct mesh *scan)
{
	static const uint8_t colour[3] = { 255, 255, 255 };
	struct looker looker = { 0 };
	int rc = chunks_create(&looker.model, scan, colour);

	memset(out, 0, copy->vertex_count);
	if (rc == 0)
		rc = raster_create(&looker.raster, SIDE_PX, false);
	if (rc == 0) {
		looker.inverse_m = malloc((size_t)SIDE_PX * SIDE_PX * sizeof(*looker.inverse_m));
		looker.pieces = malloc(looker.model->piece_count * sizeof(*looker.pieces));
		rc = looker.inverse_m && looker.pieces ? 0 : -ENOMEM;
	}
	if (rc == 0)
		rc = look(out, copy, &looker);
	raster_destroy(looker.raster);
	model_destroy(looker.model);
	free(looker.inverse_m);
	free(looker.pieces);
	return rc;
}
