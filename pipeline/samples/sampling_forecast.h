/* Predicts how much the sampler will have to draw and encode, from some places of the surface:
 * where they appear from each sampling point. */
#ifndef GOPURA_PIPELINE_SAMPLES_SAMPLING_FORECAST_H
#define GOPURA_PIPELINE_SAMPLES_SAMPLING_FORECAST_H

#include "pipeline/samples/sample_store.h"

struct sampling_forecast {
	uint32_t point_count;
	uint64_t face_count;   /* faces that show something */
	uint64_t tile_count;   /* of all levels */
	double triangle_share; /* mean share of the scan's triangles in such a face */
};

/* places: of the surface, at least 1; low_m and high_m: its bounding box. */
void sampling_forecast(struct sampling_forecast *out, const struct sample_grid *grid,
		       const float (*places_m)[3], uint32_t place_count, const float low_m[3],
		       const float high_m[3]);

#endif
