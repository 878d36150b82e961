/* Ways of flights: through doors, never through stone, short and without sharp corners. */
#include "geometry/solid_way.h"

#include <errno.h>
#include <math.h>

#include "geometry/solid_space.h"
#include "geometry/vec.h"
#include "tests/format/solid_example.h"

enum { DEPTH = 5, STEPS = 400 };

static const float low_m[3] = { -4, -4, -1 };
static const float cell_m = 0.25f;

/* A house on the ground with a door in the south, and within it a cell without a door. */
static bool house(const int32_t place[3])
{
	const int32_t x = place[0], y = place[1], z = place[2];
	const bool within = x > 5 && x < 26 && y > 5 && y < 26 && z < 22;
	const bool hollow = x > 7 && x < 24 && y > 7 && y < 24 && z < 20;
	const bool door = x > 10 && x < 15 && y < 20 && z < 12;
	const bool cell = x > 17 && x < 23 && y > 17 && y < 23 && z < 9;

	if (x == 20 && y == 20 && z == 6)
		return false; /* inside of the cell */
	return z < 4 || cell || (within && !hollow && !door);
}

static void check_free(const struct solid *solid, const struct solid_way *way)
{
	for (int i = 0; i <= STEPS; i++) {
		float point[3];

		solid_way_at(way, (float)i / STEPS, point);
		CHECK(solid_is_free(solid, point));
	}
}

/* Returns the sharpest turn on the way, in radians. */
static float sharpest(const struct solid_way *way)
{
	float most = 0;

	for (uint32_t i = 1; i + 1 < way->count; i++) {
		float in[3], out[3];

		vec_sub(in, way->points_m[i], way->points_m[i - 1]);
		vec_sub(out, way->points_m[i + 1], way->points_m[i]);
		if (vec_normalise(in) > 1e-4f && vec_normalise(out) > 1e-4f)
			most = fmaxf(most, acosf(fminf(1, vec_dot(in, out))));
	}
	return most;
}

static void leads_through_the_door(void **state)
{
	const float south[3] = { -0.8f, -3.8f, 0.8f }, north[3] = { 1, 3.5f, 1 };
	const float within[3] = { 0, 0, 1 };
	struct solid_way way;
	struct solid solid;

	(void)state;
	solid_example_init(&solid, DEPTH, cell_m, low_m, house);
	CHECK(solid_way_plan(&way, &solid, south, within) == 0);
	check_free(&solid, &way);
	CHECK(solid_way_plan(&way, &solid, north, within) == 0);
	check_free(&solid, &way);
	CHECK(vec_distance(way.points_m[0], north) == 0);
	CHECK(vec_distance(solid_way_end_m(&way), within) == 0);
	/* Around the house and through the door, or over it if that were open. */
	CHECK(solid_way_length_m(&way) > 8 && solid_way_length_m(&way) < 16);
	CHECK(way.count > 6 && sharpest(&way) < 1);
	solid_finish(&solid);
}

static void is_straight_where_nothing_is_in_between(void **state)
{
	const float from[3] = { -3.8f, -3.8f, 1 }, to[3] = { -3.8f, 30, 9 };
	struct solid_way way;
	struct solid solid;
	float point[3];

	(void)state;
	solid_example_init(&solid, DEPTH, cell_m, low_m, house);
	CHECK(solid_way_plan(&way, &solid, from, to) == 0);
	CHECK(way.count == 2);
	CHECK(fabsf(solid_way_length_m(&way) - vec_distance(from, to)) < 1e-3f);
	solid_way_at(&way, 0.25f, point);
	CHECK(fabsf(point[1] - (-3.8f + 33.8f / 4)) < 1e-3f);
	/* A way of no length. */
	CHECK(solid_way_plan(&way, &solid, from, from) == 0);
	solid_way_at(&way, 0.5f, point);
	CHECK(vec_distance(point, from) == 0 && solid_way_length_m(&way) == 0);
	solid_finish(&solid);
}

static void comes_from_far_and_passes_over(void **state)
{
	const float from[3] = { -30, 0.3f, 0.7f }, to[3] = { 40, -0.2f, 0.6f };
	struct solid_way way;
	struct solid solid;

	(void)state;
	solid_example_init(&solid, DEPTH, cell_m, low_m, house);
	CHECK(solid_way_plan(&way, &solid, from, to) == 0);
	check_free(&solid, &way);
	CHECK(solid_way_length_m(&way) > 70 && solid_way_length_m(&way) < 80);
	solid_finish(&solid);
}

static void an_end_in_stone_becomes_the_nearest_free_point(void **state)
{
	const float in_wall[3] = { -2.3f, 0, 1 }, outside[3] = { -3.9f, 0, 1 };
	struct solid_way way;
	struct solid solid;

	(void)state;
	solid_example_init(&solid, DEPTH, cell_m, low_m, house);
	CHECK(solid_way_plan(&way, &solid, outside, in_wall) == 0);
	check_free(&solid, &way);
	CHECK(vec_distance(solid_way_end_m(&way), in_wall) < 0.5f);
	/* Out of stone it goes by the shortest way, and from there through free space. */
	CHECK(solid_way_plan(&way, &solid, in_wall, outside) == 0);
	CHECK(vec_distance(way.points_m[0], in_wall) == 0);
	CHECK(vec_distance(way.points_m[1], in_wall) < 0.5f);
	for (uint32_t i = 1; i + 1 < way.count; i++)
		CHECK(solid_way_is_free(&solid, way.points_m[i], way.points_m[i + 1]));
	solid_finish(&solid);
}

static void says_that_there_is_no_way(void **state)
{
	const float within[3] = { 0, 0, 1 }, in_cell[3] = { 1.1f, 1.1f, 0.6f };
	struct solid_way way;
	struct solid solid;

	(void)state;
	solid_example_init(&solid, DEPTH, cell_m, low_m, house);
	CHECK(solid_is_free(&solid, in_cell));
	CHECK(solid_way_plan(&way, &solid, within, in_cell) == -ENOENT);
	CHECK(solid_way_plan(&way, &solid, in_cell, within) == -ENOENT);
	CHECK(way.count == 2 && vec_distance(solid_way_end_m(&way), within) == 0);
	solid_finish(&solid);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(leads_through_the_door),
		cmocka_unit_test(is_straight_where_nothing_is_in_between),
		cmocka_unit_test(comes_from_far_and_passes_over),
		cmocka_unit_test(an_end_in_stone_becomes_the_nearest_free_point),
		cmocka_unit_test(says_that_there_is_no_way),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
