/* Predicts the vertices of a patch group for the patch codec, which stores only the differences.
 * Private to format/. All arithmetic is on integers, so that every machine predicts the same
 * values.
 *
 * Positions: the parallelogram rule (Touma and Gotsman 1998, "Triangle mesh compression"). Normals:
 * the area-weighted normal of the group's own triangles. Colours: the mean of two corners of the
 * triangle. How far apart the known vertices are says how good the guess is, and chooses the model
 * of the difference.
 *
 * Positions and colours are predicted inline: a call for each vertex takes 3 % of the decoder's
 * time. */
#ifndef GOPURA_FORMAT_PREDICT_H
#define GOPURA_FORMAT_PREDICT_H

#include "base/compiler.h"
#include "format/patch_mesh.h"

/* From what a vertex is predicted: vertices that are coded before it. */
struct predict_step {
	uint32_t known_count; /* 0 to 3: how many entries of from are valid */
	uint32_t from[3];     /* 1: nearby; 2: ends of the edge; 3: also the apex across it */
};

/* Models of differences: predict_position and predict_colour return numbers below these. */
enum { PREDICT_POSITION_MODELS = 2 + 4 * 25, PREDICT_COLOUR_MODELS = 7, PREDICT_OPEN_MODELS = 6 };

/* Predicts the normals of all vertices of a group from positions and triangles alone. Call it for
 * each patch with sums that start at zero, then predict_octahedral for each vertex. */
void predict_add_normals(int64_t (*sums)[3], const struct patch_vertex *vertices,
			 const uint32_t *members, const uint16_t *indices, uint32_t triangle_count);
/* Adds the normal of one triangle, as long as twice its area. */
void predict_add_cross(int64_t sum[3], const int32_t *a, const int32_t *b, const int32_t *c);
/* Encodes a sum of normals as normal_encode does, in integers. */
void predict_octahedral(int8_t out[2], const int64_t sum[3]);

/* Parts of the functions below, for this header alone. */
static inline int32_t predict_distance(int32_t a, int32_t b)
{
	return a < b ? b - a : a - b;
}

static inline int32_t predict_larger(int32_t a, int32_t b)
{
	return a > b ? a : b;
}

static inline uint32_t predict_bit_length(int32_t number)
{
	return number == 0 ? 0 : 32 - (uint32_t)__builtin_clz((uint32_t)number);
}

/* An axis along which the known vertices differ little, beside the others, is one along which the
 * surface is flat. */
static inline uint32_t predict_position_model(int32_t extent, int32_t largest)
{
	uint32_t bits = predict_bit_length(extent), less = predict_bit_length(largest) - bits;

	return 2 + 4 * bits + (less < 3 ? less : 3);
}

/* Predict one vertex from those that its step names. vertices hold numbers without their omitted
 * low bits, positions also without the base of the group; so are the guesses, which are 0 to most
 * on each axis. models receives which model to use. */
static force_inline void predict_position(int32_t out[3], uint32_t models[3],
					  const struct predict_step *step,
					  const struct patch_vertex *vertices,
					  const int32_t most[3])
{
	const int32_t *a = vertices[step->from[0]].position;
	const int32_t *b = vertices[step->from[1]].position;
	const int32_t *c = vertices[step->from[2]].position;
	int32_t extents[3], largest = 0;

	if (step->known_count < 2) {
		for (int i = 0; i < 3; i++) {
			out[i] = step->known_count ? a[i] : 0;
			models[i] = step->known_count;
		}
		return;
	}
	if (step->known_count == 2) {
		for (int i = 0; i < 3; i++) {
			out[i] = (a[i] + b[i]) / 2;
			extents[i] = predict_distance(a[i], b[i]);
		}
	} else {
		for (int i = 0; i < 3; i++) {
			int32_t guess = a[i] + b[i] - c[i];

			out[i] = guess < 0 ? 0 : guess > most[i] ? most[i] : guess;
			extents[i] = predict_larger(predict_distance(a[i], b[i]),
						    predict_distance(a[i], c[i]));
		}
	}
	largest = predict_larger(extents[0], predict_larger(extents[1], extents[2]));
	for (int i = 0; i < 3; i++)
		models[i] = predict_position_model(extents[i], largest);
}

/* unknown: the guess where no vertex is known. Component 3 is the share of open sky. */
static force_inline void predict_colour(uint8_t out[4], uint32_t *colour_model,
					uint32_t *open_model, const struct predict_step *step,
					const struct patch_vertex *vertices,
					const uint8_t unknown[4])
{
	const uint8_t *a = step->known_count ? vertices[step->from[0]].colour : unknown;
	const uint8_t *b = step->known_count > 1 ? vertices[step->from[1]].colour : a;
	uint32_t green = predict_bit_length(predict_distance(a[1], b[1])),
		 open = (uint32_t)predict_distance(a[3], b[3]);

	for (int i = 0; i < 4; i++)
		out[i] = (uint8_t)((a[i] + b[i]) / 2);
	*colour_model = green < PREDICT_COLOUR_MODELS ? green : PREDICT_COLOUR_MODELS - 1;
	*open_model = open < PREDICT_OPEN_MODELS ? open : PREDICT_OPEN_MODELS - 1;
}

#endif
