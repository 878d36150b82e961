/* Renders a face, with GL if the scan has pictures and else with a raster, and turns the picture
 * into encoded tiles with a pyramid. */
#include "pipeline/samples/face_renderer.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/camera.h"
#include "pipeline/samples/cube_frame.h"
#include "pipeline/samples/face_features.h"
#include "pipeline/samples/pieces.h"
#include "pipeline/samples/raster.h"
#include "pipeline/samples/resolve.h"
#include "pipeline/samples/shading.h"
#include "pipeline/samples/tile_loss.h"

enum { OBJECTS_BYTES_MAX = 128 << 20 };

struct face_renderer {
	struct face_renderer_options options;
	/* if the scan has pictures */
	struct drawing *drawing;
	struct cube_frame *frame;
	struct shading *shading;
	/* if it has none */
	struct sight *sight;
	struct pieces *pieces;
	struct raster *raster;
	struct resolve *resolve;
	struct pyramid pyramid;
	int frame_px, samples; /* of the frame; per pixel and axis */
	uint8_t tile[SAMPLE_IMAGE_PX * SAMPLE_IMAGE_PX * 3];
	uint8_t decoded[SAMPLE_IMAGE_PX * SAMPLE_IMAGE_PX * 3];
	uint8_t covered[TILE_WINDOWS];                        /* windows of the tile */
	uint32_t features[FACE_TILES_MAX][SAMPLE_SCALES_MAX]; /* of all places of a face */
};

/* The picture of a level is wider than its face by the aprons that the coarsest level needs. */
static uint32_t level_px(uint32_t level)
{
	return (uint32_t)SAMPLE_IMAGE_PX << level;
}

static int create_gl(struct face_renderer *renderer)
{
	const struct face_renderer_options *options = &renderer->options;
	int side = renderer->frame_px;
	int rc = drawing_create(&renderer->drawing, options->model, options->textures,
				options->texture_count, &options->drawn);

	if (rc == 0)
		rc = cube_frame_create(&renderer->frame, side, side);
	if (rc == 0)
		rc = shading_create(&renderer->shading, renderer->frame, side, side,
				    renderer->samples);
	return rc;
}

static int create_raster(struct face_renderer *renderer)
{
	const struct drawing_options *drawn = &renderer->options.drawn;
	struct model *model = renderer->options.model;
	int rc = sight_create(&renderer->sight, model);

	if (rc == 0)
		rc = pieces_create(&renderer->pieces, model);
	if (rc == 0)
		rc = raster_create(&renderer->raster, (uint32_t)renderer->frame_px,
				   !drawn->procedural);
	if (rc == 0)
		rc = resolve_create(&renderer->resolve, renderer->raster, drawn, renderer->samples);
	return rc;
}

int face_renderer_create(struct face_renderer **out, const struct face_renderer_options *options)
{
	struct face_renderer *renderer = calloc(1, sizeof(*renderer));
	uint32_t side = level_px(options->level_count - 1);
	int rc;

	*out = NULL;
	if (!renderer)
		return -ENOMEM;
	renderer->options = *options;
	renderer->samples = options->level_count < SAMPLE_LEVELS_MAX ? 2 : 1;
	renderer->frame_px = (int)side * renderer->samples;
	rc = pyramid_init(&renderer->pyramid, side);
	if (rc == 0)
		rc = options->texture_count ? create_gl(renderer) : create_raster(renderer);
	if (rc < 0) {
		face_renderer_destroy(renderer);
		return rc;
	}
	*out = renderer;
	return 0;
}

void face_renderer_destroy(struct face_renderer *renderer)
{
	if (!renderer)
		return;
	shading_destroy(renderer->shading);
	cube_frame_destroy(renderer->frame);
	drawing_destroy(renderer->drawing);
	resolve_destroy(renderer->resolve);
	raster_destroy(renderer->raster);
	pieces_destroy(renderer->pieces);
	sight_destroy(renderer->sight);
	pyramid_finish(&renderer->pyramid);
	free(renderer);
}

struct sight *face_renderer_sight(struct face_renderer *renderer)
{
	return renderer->drawing ? drawing_sight(renderer->drawing) : renderer->sight;
}

void shot_init(struct shot *shot)
{
	memset(shot, 0, sizeof(*shot));
	buffer_init(&shot->objects, OBJECTS_BYTES_MAX);
}

void shot_finish(struct shot *shot)
{
	buffer_finish(&shot->objects);
}

static struct camera face_camera(const struct face_renderer *renderer, const float point_m[3],
				 int face)
{
	struct camera camera = { .width_px = renderer->frame_px, .height_px = renderer->frame_px };
	double tangent = (double)SAMPLE_IMAGE_PX / SAMPLE_TILE_PX;

	camera.fov_deg = (float)(2 * atan(tangent) * 180 / M_PI);
	for (int i = 0; i < 3; i++) {
		camera.eye_m[i] = point_m[i];
		camera.target_m[i] = point_m[i] + cube_axes[face].forward[i];
		camera.up[i] = cube_axes[face].up[i];
	}
	return camera;
}

/* Returns true if anything shows in a square of the level's picture, or within a pixel of it. */
static bool shows(const struct face_renderer *renderer, uint32_t level, uint32_t x, uint32_t y,
		  uint32_t side)
{
	return pyramid_shows(&renderer->pyramid, renderer->options.level_count - 1 - level, x - 1,
			     y - 1, side + 2);
}

static uint16_t find_coverage(const struct face_renderer *renderer)
{
	uint32_t level = renderer->options.level_count - 1;
	uint32_t apron = (uint32_t)SAMPLE_APRON_PX << level;
	uint32_t width = (uint32_t)SAMPLE_TILE_PX << level, side = (width + 3) / 4;
	uint16_t coverage = 0;

	for (uint32_t i = 0; i < 16; i++)
		if (shows(renderer, level, apron + i % 4 * width / 4, apron + i / 4 * width / 4,
			  side))
			coverage |= (uint16_t)(1u << i);
	return coverage;
}

/* Finds which windows of a tile show something; x, y: of its corner in the level's picture. */
static uint16_t find_windows(struct face_renderer *renderer, uint32_t finer, uint32_t x, uint32_t y)
{
	const struct pyramid *pyramid = &renderer->pyramid;
	uint16_t count = 0;

	for (uint32_t w = 0; w < TILE_WINDOWS; w++) {
		uint32_t column = x + w % TILE_WINDOW_SIDE * TILE_WINDOW_PX + TILE_WINDOW_PX / 2;
		uint32_t row = y + w / TILE_WINDOW_SIDE * TILE_WINDOW_PX + TILE_WINDOW_PX / 2;
		size_t at = (size_t)row * pyramid->side_px[finer] + column;

		renderer->covered[w] = pyramid->levels[finer][at][3] > 0;
		count += renderer->covered[w];
	}
	return count;
}

static int encode_at(struct face_renderer *renderer, struct shot *shot, int quality)
{
	return tile_encode(&shot->objects, renderer->tile, SAMPLE_IMAGE_PX, quality,
			   renderer->options.effort);
}

/* Encodes a tile at all qualities, and measures what each loses. */
static int encode_choices(struct face_renderer *renderer, struct shot *shot, uint32_t finer,
			  uint32_t x, uint32_t y)
{
	const uint32_t choices = renderer->options.choice_count, tile = shot->tile_count;
	int rc = 0;

	shot->windows[tile] = find_windows(renderer, finer, x, y);
	for (uint32_t choice = 0; rc == 0 && choice < choices; choice++) {
		size_t start = shot->objects.size;
		struct bytes object;

		rc = encode_at(renderer, shot, renderer->options.qualities[choice]);
		if (rc < 0)
			return rc;
		object = (struct bytes){ shot->objects.data + start, shot->objects.size - start };
		shot->end_of[tile * choices + choice] = (uint32_t)shot->objects.size;
		rc = tile_decode(renderer->decoded, SAMPLE_IMAGE_PX, object);
		shot->losses[tile * SAMPLE_CHOICES_MAX + choice] =
			tile_loss(renderer->tile, renderer->decoded, renderer->covered);
	}
	return rc;
}

static int encode_tile(struct face_renderer *renderer, struct shot *shot, uint32_t level,
		       uint32_t x, uint32_t y)
{
	const uint32_t finer = renderer->options.level_count - 1 - level;
	int rc;

	pyramid_sharpen(&renderer->pyramid, finer, x, y, SAMPLE_IMAGE_PX, renderer->tile);
	if (renderer->options.choice_count > 1)
		return encode_choices(renderer, shot, finer, x, y);
	rc = encode_at(renderer, shot, renderer->options.quality);
	shot->end_of[shot->tile_count] = (uint32_t)shot->objects.size;
	return rc;
}

static int cut_level(struct face_renderer *renderer, struct shot *shot, uint32_t level)
{
	uint32_t apron = (uint32_t)SAMPLE_APRON_PX << level;

	uint32_t end = face_tile_index(level + 1, 0, 0);

	for (uint32_t index = face_tile_index(level, 0, 0); index < end; index++) {
		uint32_t row, column, n = shot->tile_count;
		int rc;

		face_tile_place(level, index, &row, &column);
		uint32_t x = apron + column * SAMPLE_TILE_PX, y = apron + row * SAMPLE_TILE_PX;
		if (!shows(renderer, level, x, y, SAMPLE_TILE_PX))
			continue;
		rc = encode_tile(renderer, shot, level, x - SAMPLE_APRON_PX, y - SAMPLE_APRON_PX);
		if (rc < 0)
			return rc;
		shot->tiles[n] = (uint16_t)index;
		memcpy(shot->features[n], renderer->features[index], sizeof(shot->features[n]));
		shot->tile_count++;
	}
	return 0;
}

/* Renders into the pyramid's finest level. *found is false if nothing shows. */
static int render_gl(struct face_renderer *renderer, struct shot *shot, const struct camera *camera,
		     bool *found)
{
	const uint8_t *rgba;
	float matrix[16];
	int rc;

	camera_matrix(camera, matrix);
	cube_frame_bind(renderer->frame);
	rc = drawing_draw(renderer->drawing, matrix, camera->eye_m,
			  1 / camera_px_per_radian(camera));
	if (rc == 0)
		rc = cube_frame_range(renderer->frame, camera->near_m, camera->far_m, found,
				      &shot->near_m, &shot->far_m);
	if (rc < 0 || !*found)
		return rc;
	rc = shading_take(renderer->shading, &rgba);
	if (rc < 0)
		return rc;
	memcpy(renderer->pyramid.levels[0], rgba,
	       (size_t)renderer->pyramid.side_px[0] * renderer->pyramid.side_px[0] * 4);
	return 0;
}

/* Draws what no nearer piece hides. */
static int draw_pieces(struct face_renderer *renderer, const struct camera *camera)
{
	const struct model *model = renderer->options.model;
	const uint32_t *pieces;
	float matrix[16];
	uint32_t count;

	raster_begin(renderer->raster, camera);
	camera_matrix(camera, matrix);
	pieces = sight_visible(renderer->sight, matrix, camera->eye_m, &count);
	for (uint32_t n = 0; n < count; n++) {
		const struct model_piece *piece = &model->pieces[pieces[n]];
		struct model_mesh mesh;
		int rc;

		if (raster_hides(renderer->raster, piece->low_m, piece->high_m))
			continue;
		rc = pieces_get(renderer->pieces, pieces[n], &mesh);
		if (rc < 0)
			return rc;
		raster_draw(renderer->raster, &mesh);
	}
	return 0;
}

/* As render_gl. */
static int render_raster(struct face_renderer *renderer, struct shot *shot,
			 const struct camera *camera, bool *found)
{
	int rc = draw_pieces(renderer, camera);

	if (rc < 0)
		return rc;
	*found = raster_range(renderer->raster, &shot->near_m, &shot->far_m);
	if (*found)
		resolve_take(renderer->resolve, camera, renderer->pyramid.levels[0]);
	return 0;
}

static int render(struct face_renderer *renderer, struct shot *shot, const float point_m[3],
		  int face, bool *found)
{
	struct camera camera = face_camera(renderer, point_m, face);
	int rc;

	*found = sight_range(face_renderer_sight(renderer), point_m, cube_axes[face].forward,
			     &camera.near_m, &camera.far_m);
	if (!*found)
		return 0;
	rc = renderer->drawing ? render_gl(renderer, shot, &camera, found)
			       : render_raster(renderer, shot, &camera, found);
	if (rc == 0 && *found)
		pyramid_count(&renderer->pyramid, &shot->covered, &shot->backs);
	return rc;
}

int face_renderer_take(struct face_renderer *renderer, struct shot *shot, const float point_m[3],
		       int face, const uint8_t *background)
{
	bool found;
	int rc;

	shot->covered = shot->backs = 0;
	shot->coverage = 0;
	shot->tile_count = 0;
	buffer_clear(&shot->objects);
	rc = render(renderer, shot, point_m, face, &found);
	if (rc < 0 || !found || !shot->covered)
		return rc;
	shot->coverage = find_coverage(renderer);
	if (!shot->coverage) /* only the aprons show something */
		return 0;
	pyramid_reduce(&renderer->pyramid);
	if (background)
		pyramid_lay_over(&renderer->pyramid, background);
	else
		pyramid_fill(&renderer->pyramid);
	if (renderer->options.scale_count > 0 && renderer->raster)
		rc = face_features_count(renderer->features, renderer->raster,
					 (uint32_t)renderer->frame_px, (uint32_t)renderer->samples,
					 renderer->options.level_count);
	for (uint32_t level = 0; rc == 0 && level < renderer->options.level_count; level++)
		rc = cut_level(renderer, shot, level);
	return rc;
}
