/* Questions about free space, each beside an answer that is found the slow way. */
#include "geometry/solid_space.h"

#include <math.h>

#include "geometry/vec.h"
#include "tests/format/solid_example.h"

enum { DEPTH = 5, SIDE = 1 << DEPTH };

static const float low_m[3] = { -4, -4, -1 };
static const float cell_m = 0.25f;

/* A wall with a door, and a slab of ground. */
static bool wall(const int32_t place[3])
{
	const bool door = place[1] >= 14 && place[1] < 18 && place[2] < 12;

	return place[2] < 4 || (place[0] >= 15 && place[0] < 17 && place[2] < 25 && !door);
}

static uint32_t seed = 5;

static float random_share(void)
{
	seed = seed * 1664525 + 1013904223;
	return (float)(seed >> 8) / (1 << 24);
}

static void random_point(float out[3])
{
	for (int axis = 0; axis < 3; axis++)
		out[axis] = low_m[axis] + (random_share() * 1.2f - 0.1f) * SIDE * cell_m;
}

static bool is_free_slowly(const float point_m[3])
{
	int32_t place[3];

	for (int axis = 0; axis < 3; axis++) {
		place[axis] = (int32_t)floorf((point_m[axis] - low_m[axis]) / cell_m);
		if (place[axis] < 0 || place[axis] >= SIDE)
			return true;
	}
	return !wall(place);
}

static bool is_outside(const float point_m[3])
{
	for (int axis = 0; axis < 3; axis++)
		if (point_m[axis] < low_m[axis] || point_m[axis] >= low_m[axis] + SIDE * cell_m)
			return true;
	return false;
}

static void knows_where_an_eye_may_be(void **state)
{
	struct solid solid;
	float point[3];

	(void)state;
	solid_example_init(&solid, DEPTH, cell_m, low_m, wall);
	for (int i = 0; i < 20000; i++) {
		random_point(point);
		CHECK(solid_is_free(&solid, point) == is_free_slowly(point));
	}
	solid_finish(&solid);
}

static void a_ray_ends_where_stone_begins(void **state)
{
	struct solid solid;
	int met = 0;

	(void)state;
	solid_example_init(&solid, DEPTH, cell_m, low_m, wall);
	for (int i = 0; i < 4000; i++) {
		float from[3], to[3], way[3], at[3], reach, slowly = INFINITY;
		int axis;

		random_point(from);
		random_point(to);
		vec_sub(way, to, from);
		vec_normalise(way);
		if (i % 5 == 0)
			vec_copy(way, (float[]){ 0, i % 2 ? 1 : -1, 0 });
		reach = solid_reach(&solid, from, way, 4, &axis);
		for (float m = 0; m < 4 && isinf(slowly); m += 0.004f) {
			vec_copy(at, from);
			vec_add_scaled(at, at, m, way);
			if (!is_free_slowly(at))
				slowly = m;
		}
		/* The slow way may step over the corner of a cell, the quick one never. */
		CHECK(isinf(slowly) || (reach <= slowly + 0.001f && reach >= slowly - 0.3f));
		met += !isinf(reach);
		CHECK(solid_way_is_free(&solid, from, to) ==
			      (isinf(solid_reach(&solid, from, way, vec_distance(from, to),
						 NULL)) &&
			       solid_is_free(&solid, to)) ||
		      i % 5 == 0);
	}
	CHECK(met > 500);
	solid_finish(&solid);
}

static void a_ray_tells_which_side_it_met(void **state)
{
	const float from[3] = { -2, -2, 1 }, within[3] = { 0, -2, 1 };
	struct solid solid;
	int axis;

	(void)state;
	solid_example_init(&solid, DEPTH, cell_m, low_m, wall);
	CHECK(fabsf(solid_reach(&solid, from, (float[]){ 1, 0, 0 }, 9, &axis) - 1.75f) < 1e-5f);
	CHECK(axis == 0);
	CHECK(fabsf(solid_reach(&solid, from, (float[]){ 0, 0, -1 }, 9, &axis) - 1) < 1e-5f);
	CHECK(axis == 2);
	CHECK(isinf(solid_reach(&solid, from, (float[]){ 1, 0, 0 }, 1.7f, &axis)));
	CHECK(axis == -1);
	CHECK(solid_reach(&solid, within, (float[]){ 1, 0, 0 }, 9, &axis) == 0);
	CHECK(isinf(solid_reach(&solid, from, (float[]){ 0, 0, 0 }, 9, NULL)));
	CHECK(solid_reach(&solid, (float[]){ NAN, 0, 0 }, (float[]){ 1, 0, 0 }, 9, NULL) == 0);
	solid_finish(&solid);
}

static void finds_the_nearest_free_point(void **state)
{
	struct solid solid;

	(void)state;
	solid_example_init(&solid, DEPTH, cell_m, low_m, wall);
	for (int i = 0; i < 3000; i++) {
		float point[3], out[3], far;

		random_point(point);
		CHECK(solid_nearest_free(&solid, point, 10, out));
		CHECK(is_free_slowly(out));
		far = vec_distance(point, out);
		CHECK((far == 0) == is_free_slowly(point));
		for (int k = 0; k < 200 && far > 0.01f; k++) {
			float near[3];

			for (int axis = 0; axis < 3; axis++)
				near[axis] = point[axis] + (2 * random_share() - 1) * far;
			CHECK(is_outside(near) || vec_distance(near, point) > far - 0.01f ||
			      !is_free_slowly(near));
		}
		CHECK(far < 0.01f || !solid_nearest_free(&solid, point, far - 0.005f, out));
	}
	solid_finish(&solid);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(knows_where_an_eye_may_be),
		cmocka_unit_test(a_ray_ends_where_stone_begins),
		cmocka_unit_test(a_ray_tells_which_side_it_met),
		cmocka_unit_test(finds_the_nearest_free_point),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
