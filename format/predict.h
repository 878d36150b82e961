/* Predicts the vertices of a patch group for the patch codec, which stores only the differences.
 * Private to format/. All arithmetic is on integers, so that every machine predicts the same
 * values.
 *
 * Positions: the parallelogram rule (Touma and Gotsman 1998, "Triangle mesh compression"). Normals:
 * the area-weighted normal of the group's own triangles. Colours: the mean of two corners of the
 * triangle. How far apart the known vertices are says how good the guess is, and chooses the model
 * of the difference. */
#ifndef GOPURA_FORMAT_PREDICT_H
#define GOPURA_FORMAT_PREDICT_H

#include "base/compiler.h"
#include "format/patch_mesh.h"

/* From what a vertex is predicted: vertices that are coded before it. */
struct predict_step {
	uint32_t known_count; /* 0 to 3: how many entries of from are valid */
	uint32_t from[3];     /* 1: nearby; 2: ends of the edge; 3: also the apex across it */
};

/* Models of differences: predict_position and predict_colours return numbers below these. */
enum { PREDICT_POSITION_MODELS = 2 + 4 * 25, PREDICT_COLOUR_MODELS = 7, PREDICT_OPEN_MODELS = 6 };

/* Predict one vertex from those that its step names. vertices hold numbers without their omitted
 * low bits, positions also without the base of the group; so are the guesses, which are 0 to most
 * on each axis. models receives which model to use. */
void predict_position(int32_t out[3], uint32_t models[3], const struct predict_step *step,
		      const struct patch_vertex *vertices, const int32_t most[3]);
/* Predicts the normals of all vertices of a group from positions and triangles alone. Call it for
 * each patch with sums that start at zero, then octahedral for each vertex. */
void predict_add_normals(int64_t (*sums)[3], const struct patch_vertex *vertices,
			 const uint32_t *members, const uint16_t *indices, uint32_t triangle_count);
/* Encodes a sum of normals as normal_encode does, in integers. */
void predict_octahedral(int8_t out[2], const int64_t sum[3]);
/* unknown: the guess where no vertex is known. Component 3 is the share of open sky. */
void predict_colour(uint8_t out[4], uint32_t *colour_model, uint32_t *open_model,
		    const struct predict_step *step, const struct patch_vertex *vertices,
		    const uint8_t unknown[4]);

#endif
