/* Somebody who walks: where one stands, what one can step on, and ways up stairs and through doors.
 */
#include "geometry/foot_way.h"

#include <errno.h>
#include <math.h>

#include "geometry/solid_space.h"
#include "geometry/vec.h"
#include "tests/format/solid_example.h"

enum { DEPTH = 6, STEPS = 500 };

static const float cell_m = 0.125f;
static const float low_m[3] = { 0, 0, -1 };
/* Heights of floors: that of the ground, and of the terrace. */
#define GROUND_M  0.0f
#define TERRACE_M 1.5f

/* A terrace on the ground, with steep stairs in the middle of its western side and a balustrade in
 * the north; on it a house with a low door in the west, and a cell without one in the south. */
static bool site(const int32_t place[3])
{
	const int32_t x = place[0], y = place[1], z = place[2];
	const bool stairs = y >= 24 && y < 40 && x >= 20 && x < 32;

	if (z < 8)
		return true;
	if (stairs && z < 8 + 2 * ((x - 20) / 2))
		return true;
	if (x < 32)
		return false;
	if (z < 20)
		return true;
	if (y >= 52 && y < 54 && z < 28) /* the balustrade */
		return true;
	if (x >= 46 && x < 49 && y >= 16 && y < 52) /* the house's wall, with its door */
		return !(y >= 30 && y < 35 && z < 29);
	if (y >= 15 && y < 17 && x >= 46)
		return true;
	return y < 12 && x >= 50 && (y >= 10 || x < 52);
}

struct scene {
	struct solid solid;
	struct foot foot;
};

static struct scene begin(void)
{
	struct scene scene;

	solid_example_init(&scene.solid, DEPTH, cell_m, low_m, site);
	scene.foot = (struct foot){ .ground_m = -0.125f, .height_m = 1.6f };
	return scene;
}

/* The struct has its place only now. */
static struct foot_stance stand(struct scene *scene, float x, float y, float z)
{
	struct foot_stance stance;

	scene->foot.solid = &scene->solid;
	CHECK(foot_stand(&scene->foot, (const float[3]){ x, y, z }, INFINITY, &stance));
	return stance;
}

static void stands_upright_or_stoops_or_not_at_all(void **state)
{
	struct scene scene = begin();
	struct foot_stance at = stand(&scene, 1, 1, 3);
	const float upright = 1.6f - cell_m;

	(void)state;
	CHECK(fabsf(at.floor_m - GROUND_M) < 1e-3f);
	CHECK(fabsf(at.eye_m[2] - (GROUND_M + upright)) < 0.01f && at.eye_m[0] == 1);
	at = stand(&scene, 5, 4.5f, 4);
	CHECK(fabsf(at.floor_m - TERRACE_M) < 1e-3f);
	/* In the door, which is nine cells high. */
	at = stand(&scene, 5.9f, 4.05f, 2);
	CHECK(at.eye_m[2] < TERRACE_M + 9 * cell_m && at.eye_m[2] > TERRACE_M + 8 * cell_m);
	/* In stone, and too far down. */
	CHECK(!foot_stand(&scene.foot, (const float[3]){ 5, 4.5f, 1 }, INFINITY, &at));
	CHECK(!foot_stand(&scene.foot, (const float[3]){ 1, 1, 3 }, 2, &at));
	/* Beyond the octree the ground goes on. */
	CHECK(foot_stand(&scene.foot, (const float[3]){ -20, 3, 2 }, INFINITY, &at));
	CHECK(fabsf(at.floor_m - GROUND_M) < 1e-3f);
	solid_finish(&scene.solid);
}

static void steps_up_stairs_but_not_up_a_terrace(void **state)
{
	struct scene scene = begin();
	struct foot_stance at = stand(&scene, 2.3f, 4, 1), wall = stand(&scene, 3.8f, 1, 1);
	struct foot_stance rail = stand(&scene, 5, 6.4f, 3);

	(void)state;
	while (at.eye_m[0] < 4.2f)
		CHECK(foot_step(&scene.foot, &at, at.eye_m[0] + 0.35f, 4, &at));
	CHECK(fabsf(at.floor_m - TERRACE_M) < 1e-3f);
	while (at.eye_m[0] > 2.2f)
		CHECK(foot_step(&scene.foot, &at, at.eye_m[0] - 0.35f, 4, &at));
	CHECK(fabsf(at.floor_m - GROUND_M) < 1e-3f);
	CHECK(!foot_step(&scene.foot, &wall, 4.1f, 1, &wall) && wall.eye_m[0] == 3.8f);
	/* Nor over a balustrade of a metre, which is thinner than a step. */
	CHECK(!foot_step(&scene.foot, &rail, 5, 6.85f, &rail));
	solid_finish(&scene.solid);
}

/* The highest floor where a foot may be, around a place of the eye: half a step beside it. */
static float floor_below(const struct scene *scene, const float at_m[3])
{
	float highest = -INFINITY;

	for (int side = 0; side < 9; side++) {
		const float from[3] = { at_m[0] + 0.17f * (float)(side % 3 - 1),
					at_m[1] + 0.17f * (float)(side / 3 - 1), at_m[2] };
		struct foot_stance under;

		if (foot_stand(&scene->foot, from, INFINITY, &under))
			highest = fmaxf(highest, under.floor_m);
	}
	return highest;
}

/* Everywhere free, and as high above the floor as somebody is who walks there, or steps down. */
static void check_way(const struct scene *scene, const struct solid_way *way)
{
	for (int i = 0; i <= STEPS; i++) {
		float at[3], high_m;

		solid_way_at(way, (float)i / STEPS, at);
		CHECK(solid_is_free(&scene->solid, at));
		high_m = at[2] - floor_below(scene, at);
		CHECK(high_m > 0.3f && high_m < 2.45f);
	}
}

static void climbs_and_goes_through_a_low_door(void **state)
{
	struct scene scene = begin();
	const struct foot_stance from = stand(&scene, 1, 1, 1), to = stand(&scene, 7, 6, 3);
	struct solid_way way, back;
	float steepest = 0;

	(void)state;
	CHECK(foot_way_plan(&way, &scene.foot, &from, &to) == 0);
	check_way(&scene, &way);
	CHECK(vec_distance(way.points_m[0], from.eye_m) < 1e-3f);
	CHECK(vec_distance(solid_way_end_m(&way), to.eye_m) < 1e-3f);
	CHECK(solid_way_length_m(&way) > 8 && solid_way_length_m(&way) < 16);
	/* The stairs rise 45 degrees in steps of a quarter of a metre; the way does not jump. */
	for (uint32_t i = 1; i < way.count; i++) {
		const float *a = way.points_m[i - 1], *b = way.points_m[i];

		if (b[0] > 5)
			break; /* there one stoops, which takes no step */
		steepest = fmaxf(steepest, fabsf(b[2] - a[2]) /
						   fmaxf(hypotf(b[0] - a[0], b[1] - a[1]), 0.01f));
	}
	CHECK(steepest < 1.6f);
	CHECK(foot_way_plan(&back, &scene.foot, &to, &from) == 0);
	check_way(&scene, &back);
	solid_finish(&scene.solid);
}

static void goes_as_near_as_it_can(void **state)
{
	struct scene scene = begin();
	const struct foot_stance from = stand(&scene, 1, 1, 1);
	const struct foot_stance cell = stand(&scene, 7.2f, 0.6f, 3);
	struct solid_way way;

	(void)state;
	CHECK(foot_way_plan(&way, &scene.foot, &from, &cell) == 0);
	check_way(&scene, &way);
	CHECK(vec_distance(solid_way_end_m(&way), cell.eye_m) < 2);
	/* Nothing is nearer than the place itself. */
	CHECK(foot_way_plan(&way, &scene.foot, &cell, &from) == 0 ||
	      vec_distance(solid_way_end_m(&way), from.eye_m) > 0);
	solid_finish(&scene.solid);
}

static void a_wall_that_is_touched_leads_before_it(void **state)
{
	struct scene scene = begin();
	const float eye[3] = { 2, 1, 1.5f }, floor[3] = { 3, 2, -0.125f },
		    wall[3] = { 4.125f, 1, 0.8f };
	const float nowhere[3] = { 9, 9, -40 };
	struct foot_stance at = stand(&scene, 1, 1, 1);

	(void)state;
	CHECK(foot_stand_at(&scene.foot, floor, eye, &at) && at.eye_m[0] == 3 && at.eye_m[1] == 2);
	CHECK(foot_stand_at(&scene.foot, wall, eye, &at) && at.eye_m[0] < 4 && at.eye_m[0] > 2);
	CHECK(fabsf(at.floor_m - GROUND_M) < 1e-3f);
	/* What lies below the ground is taken for the ground. */
	CHECK(foot_stand_at(&scene.foot, nowhere, eye, &at) && fabsf(at.floor_m) < 1e-3f);
	solid_finish(&scene.solid);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(stands_upright_or_stoops_or_not_at_all),
		cmocka_unit_test(steps_up_stairs_but_not_up_a_terrace),
		cmocka_unit_test(climbs_and_goes_through_a_low_door),
		cmocka_unit_test(goes_as_near_as_it_can),
		cmocka_unit_test(a_wall_that_is_touched_leads_before_it),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
