/* Renders the samples of a content folder into its store (pipeline/samples/sample_store.h): finds
 * the sampling points, leaves out those in solid matter, below the ground or with nothing to see,
 * and shares the rest among processes. docs/samples.md. */
#ifndef GOPURA_PIPELINE_SAMPLES_SAMPLER_H
#define GOPURA_PIPELINE_SAMPLES_SAMPLER_H

#include "pipeline/content/content.h"
#include "pipeline/samples/sample_store.h"

struct sampler_options {
	uint32_t jobs; /* processes; 0: one a core */
	uint32_t shard,
		shard_count; /* of all points those with number % count == shard; 0, 1: all */
	bool below_ground;   /* points also below the lowest point of the model */
};

/* Where the sampling points of a model lie: over a box half as large again, `points` along the
 * longest side, as many on the others as keep the distances alike; above the ground unless
 * below_ground. */
void sampler_grid(struct sample_grid *out, const float low_m[3], const float high_m[3],
		  uint32_t points, uint32_t face_px, bool below_ground);
void sampler_point(float out[3], const struct sample_grid *grid, const uint32_t point[3]);

/* Makes what is missing. Shows progress; errors are in fault. A run that was interrupted goes on
 * where it stopped. The result depends on nothing but the folder. */
must_check int sampler_run(const struct content *content, const struct sampler_options *options,
			   struct fault *fault);

#endif
