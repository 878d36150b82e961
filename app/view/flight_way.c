/* Chooses the path of a camera flight: a straight line, or a quadratic Bezier curve that bends up
 * or to a side around obstacles. Candidate curves are tried in order of their bend, each tested in
 * short segments. */
#include "app/view/flight_way.h"

#include <math.h>
#include <stddef.h>

#include "base/compiler.h"
#include "geometry/vec.h"

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
		vec_copy(from, to);
		flight_way_at(way, (float)i / STEPS, to);
		length += vec_distance(from, to);
	}
	return length;
}

static bool way_is_free(const struct flight_way *way, flight_way_free *is_free, void *data)
{
	float from[3], to[3];

	flight_way_at(way, 0, to);
	for (int i = 1; i <= STEPS; i++) {
		vec_copy(from, to);
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

	vec_copy(way->from_m, from_m);
	vec_copy(way->to_m, to_m);
	vec_mix(middle, way->from_m, way->to_m, 0.5f);
	vec_copy(way->over_m, middle);
	if (way_is_free(way, is_free, data))
		return;
	vec_sub(across, way->to_m, way->from_m);
	length_m = vec_length(across);
	/* A short move gets no large detour. */
	reach_m = fmaxf(length_m / 2, fminf(size_m / 2, 2 * length_m));
	vec_copy(side, (float[]){ -across[1], across[0], 0 });
	if (vec_length(side) < 1e-6f * reach_m)
		side[0] = 1; /* the flight is vertical: any side will do */
	vec_normalise(side);
	for (size_t i = 0; i < ARRAY_COUNT(bows); i++) {
		for (size_t k = 0; k < ARRAY_COUNT(bends); k++) {
			vec_copy(way->over_m, middle);
			way->over_m[2] += bows[i] * bends[k][0] * reach_m;
			vec_add_scaled(way->over_m, way->over_m, bows[i] * bends[k][1] * reach_m,
				       side);
			if (way_is_free(way, is_free, data))
				return;
		}
	}
	vec_copy(way->over_m, middle);
}
