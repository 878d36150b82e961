/* The keys of an animation's channel (glTF 2.0, 3.11), and their values at any time. */
#ifndef GOPURA_PIPELINE_SCENE_GLTF_SAMPLER_H
#define GOPURA_PIPELINE_SCENE_GLTF_SAMPLER_H

#include "pipeline/scene/gltf.h"

enum {
	GLTF_PIECES = 8,       /* straight ones into which a segment of a cubic spline is divided */
	GLTF_WEIGHTS_MAX = 64, /* of a mesh: numbers that a key has at most */
};

enum gltf_shape { GLTF_LINEAR, GLTF_STEP, GLTF_CUBIC };

/* Borrows from the document. */
struct gltf_sampler {
	struct gltf_numbers times, values;
	enum gltf_shape shape;
	uint32_t width; /* numbers of a value */
	bool is_flat;   /* each number is an element of values: those of weights are */
};

/* Gets the sampler of an animation's channel whose values have `width` numbers. The times ascend
 * from 0 to at most an hour. -EBADMSG with a diagnostic: it is not valid. */
must_check int gltf_sampler_read(struct gltf_sampler *out, const struct gltf *gltf,
				 const struct cJSON *animation, const struct cJSON *channel,
				 uint32_t width);
/* The same for `width` weights of morph targets, 1 to GLTF_WEIGHTS_MAX. */
must_check int gltf_sampler_read_weights(struct gltf_sampler *out, const struct gltf *gltf,
					 const struct cJSON *animation, const struct cJSON *channel,
					 uint32_t width);
/* Returns the seconds of the last key. */
float gltf_sampler_end_s(const struct gltf_sampler *sampler);

/* As keys between which values change evenly: a step becomes two keys at one time, and a segment of
 * a cubic spline GLTF_PIECES pieces. */
uint32_t gltf_sampler_key_count(const struct gltf_sampler *sampler);
/* Sets value to that of a key, which may not be finite, and returns its seconds. */
float gltf_sampler_key(float *value, const struct gltf_sampler *sampler, uint32_t key);
/* Makes a turn of 4 numbers a unit one. Returns false if it is none. */
bool gltf_make_turn(float turn[4]);

#endif
