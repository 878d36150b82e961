/* Plans ways through free space: a search from cell to cell, of which straight lines leave out what
 * they can, and whose corners are cut. */
#include "geometry/solid_way.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/solid_search.h"
#include "geometry/solid_space.h"
#include "geometry/vec.h"

#define WIDE_ROOMS 6.f   /* how far from a corner a curve begins, in rooms of an eye */
#define WIDE_SHARE 0.45f /* or in lengths of the line, if that is less */
#define CUT_SHARE  0.25f /* of a line, at each of its ends: how far from a corner it is cut */

enum {
	ROUNDS = 2, /* of cutting corners: each doubles their number */
	TRIALS = 4  /* of widening a corner, each half as far as the one before */
};

void solid_way_measure(struct solid_way *way)
{
	way->at_m[0] = 0;
	for (uint32_t i = 1; i < way->count; i++)
		way->at_m[i] =
			way->at_m[i - 1] + vec_distance(way->points_m[i - 1], way->points_m[i]);
}

void solid_way_straight(struct solid_way *way, const float from_m[3], const float to_m[3])
{
	way->count = 2;
	vec_copy(way->points_m[0], from_m);
	vec_copy(way->points_m[1], to_m);
	solid_way_measure(way);
}

float solid_way_length_m(const struct solid_way *way)
{
	return way->at_m[way->count - 1];
}

const float *solid_way_end_m(const struct solid_way *way)
{
	return way->points_m[way->count - 1];
}

void solid_way_at(const struct solid_way *way, float share, float out_m[3])
{
	const float at_m = share * solid_way_length_m(way);
	uint32_t i = 1;
	float line_m;

	while (i + 1 < way->count && way->at_m[i] < at_m)
		i++;
	line_m = way->at_m[i] - way->at_m[i - 1];
	if (share >= 1 || line_m <= 0)
		vec_copy(out_m, way->points_m[share >= 1 ? way->count - 1 : i]);
	else
		vec_mix(out_m, way->points_m[i - 1], way->points_m[i],
			vec_most(0, (at_m - way->at_m[i - 1]) / line_m));
}

/* ---- planning */

/* Returns the smallest cell that is nearest to a point. */
static void place_of(const struct solid *solid, const float point_m[3], int32_t place[3])
{
	const float last = (float)((1 << solid->depth) - 1);

	for (int axis = 0; axis < 3; axis++) {
		const float at = (point_m[axis] - solid->low_m[axis]) / solid->cell_m;

		place[axis] = (int32_t)vec_least(vec_most(at, 0), last);
	}
}

/* Keeps of a way only what is needed: from each point it goes straight to the farthest point up to
 * which the straight line is free. Returns the new count. */
static uint32_t pull(const struct solid *solid, float (*points_m)[3], uint32_t count)
{
	uint32_t kept = 1;

	for (uint32_t at = 0; at + 1 < count;) {
		uint32_t next = at + 1;

		while (next + 1 < count &&
		       solid_way_is_free(solid, points_m[kept - 1], points_m[next + 1]))
			next++;
		vec_copy(points_m[kept++], points_m[next]);
		at = next;
	}
	return kept;
}

/* Writes three points for a corner, up to reach_m before and after it: the middle one so far out
 * that the curve, when corners are cut, does not leave the corner on its inner side, where the
 * stone is that the way goes around. Returns whether the lines between them are free. */
static bool widen(const struct solid_way *way, uint32_t i, const struct solid *solid, float reach_m,
		  float out_m[3][3])
{
	const float *before = way->points_m[i - 1], *corner = way->points_m[i];
	const float *after = way->points_m[i + 1];
	const float before_m = vec_distance(before, corner), after_m = vec_distance(after, corner);
	float middle[3], away[3];

	if (before_m <= 0 || after_m <= 0)
		return false;
	vec_mix(out_m[0], corner, before, vec_least(reach_m / before_m, WIDE_SHARE));
	vec_mix(out_m[2], corner, after, vec_least(reach_m / after_m, WIDE_SHARE));
	vec_mix(middle, out_m[0], out_m[2], 0.5f);
	vec_sub(away, corner, middle);
	vec_copy(out_m[1], corner);
	vec_add_scaled(out_m[1], out_m[1], 1 / 3.f, away);
	return solid_way_is_free(solid, before, out_m[0]) &&
	       solid_way_is_free(solid, out_m[0], out_m[1]) &&
	       solid_way_is_free(solid, out_m[1], out_m[2]) &&
	       solid_way_is_free(solid, out_m[2], after);
}

/* Widens each corner as far as there is room. */
static void widen_corners(struct solid_way *way, const struct solid *solid)
{
	struct solid_way out = { .count = 1 };

	vec_copy(out.points_m[0], way->points_m[0]);
	for (uint32_t i = 1; i + 1 < way->count; i++) {
		float reach_m = WIDE_ROOMS * solid->room_m, three[3][3];
		int trial = 0;

		while (trial < TRIALS && !widen(way, i, solid, reach_m, three)) {
			reach_m /= 2;
			trial++;
		}
		if (trial == TRIALS || out.count + 3 + (way->count - i) > SOLID_WAY_POINTS_MAX) {
			vec_copy(out.points_m[out.count++], way->points_m[i]);
			continue;
		}
		for (int k = 0; k < 3; k++)
			vec_copy(out.points_m[out.count++], three[k]);
	}
	vec_copy(out.points_m[out.count++], way->points_m[way->count - 1]);
	*way = out;
}

/* Cuts each corner where the short cut is free. Nothing else leaves the way. */
static void cut_corners(struct solid_way *way, const struct solid *solid)
{
	struct solid_way out = { .count = 1 };

	vec_copy(out.points_m[0], way->points_m[0]);
	for (uint32_t i = 1; i + 1 < way->count; i++) {
		float before[3], after[3];

		vec_mix(before, way->points_m[i], way->points_m[i - 1], CUT_SHARE);
		vec_mix(after, way->points_m[i], way->points_m[i + 1], CUT_SHARE);
		/* Rounding may carry a point of a free line across the side of a cell. */
		if (out.count + way->count - i + 1 <= SOLID_WAY_POINTS_MAX &&
		    solid_way_is_free(solid, out.points_m[out.count - 1], before) &&
		    solid_way_is_free(solid, before, after) &&
		    solid_way_is_free(solid, after, way->points_m[i + 1])) {
			vec_copy(out.points_m[out.count++], before);
			vec_copy(out.points_m[out.count++], after);
		} else {
			vec_copy(out.points_m[out.count++], way->points_m[i]);
		}
	}
	vec_copy(out.points_m[out.count++], way->points_m[way->count - 1]);
	*way = out;
}

/* Finds a way around: the ends, and the cells between them. */
static int go_around(struct solid_way *way, const struct solid *solid, const float from_m[3],
		     const float to_m[3])
{
	int32_t from[3], to[3];
	float(*cells_m)[3], (*all_m)[3];
	uint32_t count;
	int rc;

	place_of(solid, from_m, from);
	place_of(solid, to_m, to);
	rc = solid_search(solid, from, to, &cells_m, &count);
	if (rc < 0)
		return rc;
	all_m = malloc((count + 2) * sizeof(*all_m));
	if (!all_m) {
		free(cells_m);
		return -ENOMEM;
	}
	vec_copy(all_m[0], from_m);
	for (uint32_t i = 0; i < count; i++)
		vec_copy(all_m[i + 1], cells_m[i]);
	vec_copy(all_m[count + 1], to_m);
	count = pull(solid, all_m, count + 2);
	count = pull(solid, all_m, count);
	rc = count <= SOLID_WAY_POINTS_MAX ? 0 : -ENOENT;
	for (uint32_t i = 0; rc == 0 && i < count; i++)
		vec_copy(way->points_m[i], all_m[i]);
	way->count = rc == 0 ? count : way->count;
	free(cells_m);
	free(all_m);
	return rc;
}

/* Puts the point where it begins, which is not free, before the way. */
static int leave_stone(struct solid_way *way, const float from_m[3])
{
	if (way->count == SOLID_WAY_POINTS_MAX)
		return -ENOENT;
	memmove(way->points_m[1], way->points_m[0], way->count * sizeof(*way->points_m));
	vec_copy(way->points_m[0], from_m);
	way->count++;
	return 0;
}

int solid_way_plan(struct solid_way *way, const struct solid *solid, const float from_m[3],
		   const float to_m[3])
{
	float from[3], to[3];
	int rc = 0;

	solid_way_straight(way, from_m, to_m);
	if (!solid_nearest_free(solid, from_m, INFINITY, from) ||
	    !solid_nearest_free(solid, to_m, INFINITY, to))
		return -ENOENT;
	solid_way_straight(way, from, to);
	if (!solid_way_is_free(solid, from, to))
		rc = go_around(way, solid, from, to);
	if (rc == 0)
		widen_corners(way, solid);
	for (int round = 0; rc == 0 && round < ROUNDS; round++)
		cut_corners(way, solid);
	if (rc == 0 && vec_distance(from, from_m) > 0)
		rc = leave_stone(way, from_m);
	solid_way_measure(way);
	return rc;
}
