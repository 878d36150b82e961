/* Makes a range image of a face's depth and counts its feature points tile by tile. */
#include "pipeline/samples/face_features.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/samples/scale_space.h"

static const struct scale_space_options scale_options = { SAMPLE_SCALES_MAX,
							  { 1, 2, 4, 8, 16 },
							  0.004f };

/* The mean of those samples of a texel that show something; finer: of them along an axis. */
static float texel(const struct raster *raster, uint32_t x0, uint32_t y0, uint32_t finer)
{
	struct raster_block block;
	uint32_t seen = 0;
	float sum = 0;

	if (!raster_get_block(raster, x0 / RASTER_BLOCK_PX, y0 / RASTER_BLOCK_PX, &block))
		return 0;
	for (uint32_t k = 0; k < finer * finer; k++) {
		uint32_t x = (x0 + k % finer) % RASTER_BLOCK_PX;
		uint32_t y = (y0 + k / finer) % RASTER_BLOCK_PX;
		float near = block.inverse_m[y * RASTER_BLOCK_PX + x];

		sum += near;
		seen += near > 0;
	}
	return seen ? sum / (float)seen : 0;
}

/* Adds the points of the queue to the tiles that they are in; a point counts at its last scale and
 * at all finer ones. */
static void count_points(uint32_t (*out)[SAMPLE_SCALES_MAX], struct feature_queue *queue,
			 uint32_t side, uint32_t level_count)
{
	uint32_t point;

	for (uint32_t scale = SAMPLE_SCALES_MAX; scale > 0; scale--)
		while (feature_queue_pop(queue, scale, &point))
			for (uint32_t level = 0; level < level_count; level++) {
				uint32_t tiles = 1u << level;
				uint32_t row = point / side * tiles / side;
				uint32_t column = point % side * tiles / side;
				uint32_t *counts = out[face_tile_index(level, row, column)];

				for (uint32_t s = 0; s < scale; s++)
					counts[s]++;
			}
}

int face_features_count(uint32_t (*out)[SAMPLE_SCALES_MAX], const struct raster *raster,
			uint32_t side_px, uint32_t samples, uint32_t level_count)
{
	const uint32_t finer = 2 * samples, side = side_px / finer;
	struct range_image image = { side, side, NULL };
	float *inverse_m = malloc((size_t)side * side * sizeof(*inverse_m));
	struct feature_queue queue = { 0 };
	struct scale_map map = { 0 };
	int rc = inverse_m ? 0 : -ENOMEM;

	memset(out, 0, face_tile_index(level_count, 0, 0) * sizeof(*out));
	for (uint32_t i = 0; rc == 0 && i < side * side; i++)
		inverse_m[i] = texel(raster, i % side * finer, i / side * finer, finer);
	image.inverse_m = inverse_m;
	if (rc == 0)
		rc = scale_map_make(&map, &image, &scale_options);
	if (rc == 0)
		rc = feature_queue_make(&queue, &map);
	if (rc == 0)
		count_points(out, &queue, side, level_count);
	feature_queue_finish(&queue);
	scale_map_finish(&map);
	free(inverse_m);
	return rc;
}
