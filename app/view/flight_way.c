/* Chooses the path of a camera flight: a straight line, or a quadratic Bezier curve that bends up
 * or to a side around obstacles. Candidate curves are tried in order of their bend, each tested in
 * short segments. */
#include "app/view/flight_way.h"

#include <cglm/cglm.h>

#include "base/compiler.h"

enum { STEPS = 16 };

void flight_way_at(const struct flight_way *way, float t, float out_m[3])
{
	const float s = 1 - t;

	for (int k = 0; k < 3; k++)
		out_m[k] =
			s * s * way->from_m[k] + 2 * s * t * way->over_m[k] + t * t * way->to_m[k];
}

float flight_way_length_m(const struct flight_way *way)
{
	float from[3], to[3], length = 0;

	flight_way_at(way, 0, to);
	for (int i = 1; i <= STEPS; i++) {
		glm_vec3_copy(to, from);
		flight_way_at(way, (float)i / STEPS, to);
		length += glm_vec3_distance(from, to);
	}
	return length;
}

static bool way_is_free(const struct flight_way *way, flight_way_free *is_free, void *data)
{
	float from[3], to[3];

	flight_way_at(way, 0, to);
	for (int i = 1; i <= STEPS; i++) {
		glm_vec3_copy(to, from);
		flight_way_at(way, (float)i / STEPS, to);
		if (!is_free(data, from, to))
			return false;
	}
	return true;
}

void flight_way_choose(struct flight_way *way, const float from_m[3], const float to_m[3],
		       float size_m, flight_way_free *is_free, void *data)
{
	/* Directions of the bend: up and sideways, as shares of its size. */
	static const float bends[][2] = {
		{ 1, 0 }, { 0, 1 }, { 0, -1 }, { 0.7f, 0.7f }, { 0.7f, -0.7f }
	};
	static const float bows[] = { 0.25f, 0.5f, 1, 1.6f, 2.4f };
	float across[3], side[3], middle[3], length_m, reach_m;

	glm_vec3_copy((float *)from_m, way->from_m);
	glm_vec3_copy((float *)to_m, way->to_m);
	glm_vec3_lerp(way->from_m, way->to_m, 0.5f, middle);
	glm_vec3_copy(middle, way->over_m);
	if (way_is_free(way, is_free, data))
		return;
	glm_vec3_sub(way->to_m, way->from_m, across);
	length_m = glm_vec3_norm(across);
	/* A short move gets no large detour. */
	reach_m = fmaxf(length_m / 2, fminf(size_m / 2, 2 * length_m));
	glm_vec3_copy((vec3){ -across[1], across[0], 0 }, side);
	if (glm_vec3_norm(side) < 1e-6f * reach_m)
		side[0] = 1; /* the flight is vertical: any side will do */
	glm_vec3_normalize(side);
	for (size_t i = 0; i < ARRAY_COUNT(bows); i++) {
		for (size_t k = 0; k < ARRAY_COUNT(bends); k++) {
			glm_vec3_copy(middle, way->over_m);
			way->over_m[2] += bows[i] * bends[k][0] * reach_m;
			glm_vec3_muladds(side, bows[i] * bends[k][1] * reach_m, way->over_m);
			if (way_is_free(way, is_free, data))
				return;
		}
	}
	glm_vec3_copy(middle, way->over_m);
}
