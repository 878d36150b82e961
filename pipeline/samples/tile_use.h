/* How much of a kiosk's settled pictures the tiles of a sample store make up, foretold from what
 * its plan (render/plan) would choose in views spread over the model: docs/quality.md. Bytes of a
 * tile that is hardly ever shown at rest are spent in vain. */
#ifndef GOPURA_PIPELINE_SAMPLES_TILE_USE_H
#define GOPURA_PIPELINE_SAMPLES_TILE_USE_H

#include "geometry/patch_bvh.h"
#include "pipeline/samples/sample_store.h"

/* A part of the surface that kiosks draw. */
struct tile_use_patch {
	struct patch_bvh bvh;
	float centre_m[3], radius_m; /* of a sphere around it */
};

/* Sets *out to a weight for each tile, in the order of samples_store_next. It is the same for all
 * tiles of a level of a face: how many pixels of settled pictures one of their pixels makes, as a
 * share of the mean, and a little more. Views are spread around the start view. Without a surface,
 * all weights are 1. *out is owned by the caller (free); NULL on failure. The result depends on the
 * arguments alone. -ENOMEM, -EBADMSG. */
must_check int tile_use_make(float **out, struct samples_store *store,
			     const struct tile_use_patch *patches, uint32_t patch_count,
			     const float start_eye_m[3], const float start_target_m[3]);

#endif
