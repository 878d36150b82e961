/* Feature points of the tiles of a face: its depth is a range image (scale_space.h). */
#ifndef GOPURA_PIPELINE_SAMPLES_FACE_FEATURES_H
#define GOPURA_PIPELINE_SAMPLES_FACE_FEATURES_H

#include "pipeline/samples/raster.h"
#include "pipeline/samples/sample_store.h"

/* Counts for each tile of a face (face_tile_index), of all levels, the feature points that survive
 * at least to each scale: sigma is 1, 2, 4, 8 and 16 texels of a range image of half the finest
 * level's side. raster holds the face, side_px of the frame with 1 or 2 samples a pixel. Returns
 * -ENOMEM. */
must_check int face_features_count(uint32_t (*out)[SAMPLE_SCALES_MAX], const struct raster *raster,
				   uint32_t side_px, uint32_t samples, uint32_t level_count);

#endif
