#include "app/view/navigator.h"

#include <math.h>

#include "geometry/solid_space.h"
#include "geometry/vec.h"
#include "tests/app/view/random_hand.h"
#include "tests/check.h"
#include "tests/format/solid_example.h"

enum { HEIGHT_PX = 720 };

static const struct navigator_options hall = {
	.box_min_m = { -20, -20, 0 },
	.box_max_m = { 20, 20, 24 },
	.home_eye_m = { -50, 3, 12 },
	.home_target_m = { 0, 0, 8 },
	.fov_deg = 45,
};

/* Where a point is on the panel, in tangents of the view. */
static void on_panel(const struct navigator *nav, const float point_m[3], float out[2])
{
	/* 90 degrees high and 2 pixels: a pixel is 1. */
	struct camera camera = { .width_px = 2, .height_px = 2 };

	navigator_camera(nav, &camera);
	camera.fov_deg = 90;
	CHECK(camera_pixel(&camera, point_m, &out[0], &out[1]));
	out[0] -= 1;
	out[1] = 1 - out[1];
}

static void check_pivot_stays(const struct navigator *before, const struct navigator *after,
			      const float pivot_m[3], float dx, float dy)
{
	float a[2], b[2];

	on_panel(before, pivot_m, a);
	on_panel(after, pivot_m, b);
	CHECK(fabsf(b[0] - a[0] - dx) < 2e-3f);
	CHECK(fabsf(b[1] - a[1] - dy) < 2e-3f);
}

static const float pivot[3] = { -12, 5, 6 };

static void turning_keeps_the_touched_point_under_the_finger(void **state)
{
	struct navigator nav, before;

	(void)state;
	navigator_init(&nav, &hall);
	navigator_grab(&nav, pivot);
	before = nav;
	navigator_turn(&nav, 120, 40, HEIGHT_PX);
	CHECK(vec_distance(nav.eye_m, before.eye_m) > 5);
	check_pivot_stays(&before, &nav, pivot, 0, 0);
	CHECK(fabsf(vec_distance(nav.eye_m, pivot) - vec_distance(before.eye_m, pivot)) < 1e-2f);
}

static void a_finger_to_the_right_turns_the_model_to_the_right(void **state)
{
	struct navigator nav;
	const float beside[3] = { -20, 0, 8 }; /* nearer to the eye than the pivot */
	const float middle[3] = { 0, 0, 8 };
	float a[2], b[2];

	(void)state;
	navigator_init(&nav, &hall);
	navigator_grab(&nav, middle);
	on_panel(&nav, beside, a);
	navigator_turn(&nav, 50, 0, HEIGHT_PX);
	on_panel(&nav, beside, b);
	CHECK(b[0] > a[0]);
	on_panel(&nav, beside, a);
	navigator_turn(&nav, 0, 50, HEIGHT_PX); /* down: what is near comes down */
	on_panel(&nav, beside, b);
	CHECK(b[1] < a[1]);
}

static void parting_fingers_come_nearer_and_keep_the_point(void **state)
{
	struct navigator nav, before;
	float was;

	(void)state;
	navigator_init(&nav, &hall);
	navigator_grab(&nav, pivot);
	before = nav;
	was = vec_distance(nav.eye_m, pivot);
	navigator_pinch(&nav, 2, 0, 0, 0, HEIGHT_PX);
	CHECK(fabsf(vec_distance(nav.eye_m, pivot) - was / 2) < 0.05f);
	check_pivot_stays(&before, &nav, pivot, 0, 0);
}

static void panning_moves_the_point_with_the_fingers(void **state)
{
	const float focal_px = HEIGHT_PX / 2 / tanf(45 * (float)M_PI / 360);
	struct navigator nav, before;

	(void)state;
	navigator_init(&nav, &hall);
	navigator_grab(&nav, pivot);
	before = nav;
	navigator_pinch(&nav, 1, 30, -20, 0, HEIGHT_PX);
	check_pivot_stays(&before, &nav, pivot, 30 / focal_px, 20 / focal_px);
}

static float wall_at_minus_21(void *data, const float from[3], const float direction[3], float most,
			      int *axis)
{
	float d = direction[0] > 0 ? (-21 - from[0]) / direction[0] : INFINITY;

	(void)data;
	*axis = -1;
	return d >= 0 && d < most ? d : INFINITY;
}

static void never_passes_a_wall(void **state)
{
	struct navigator_options options = hall;
	struct navigator nav;

	(void)state;
	options.reach = wall_at_minus_21;
	navigator_init(&nav, &options);
	navigator_grab(&nav, pivot); /* behind the wall */
	for (int i = 0; i < 200; i++) {
		navigator_pinch(&nav, 1.2f, 5, 3, 0.01f, HEIGHT_PX);
		navigator_turn(&nav, 11, 7, HEIGHT_PX);
		CHECK(nav.eye_m[0] < -21);
	}
}

static void stays_above_ground_and_near(void **state)
{
	struct navigator nav;

	(void)state;
	navigator_init(&nav, &hall);
	navigator_grab(&nav, pivot);
	for (int i = 0; i < 300; i++) {
		navigator_turn(&nav, 13, i < 150 ? -40 : 40, HEIGHT_PX);
		navigator_pinch(&nav, 0.9f, 0, i % 50, 0, HEIGHT_PX);
		CHECK(nav.eye_m[2] >= 0.24f);
		CHECK(vec_length(nav.eye_m) < 100);
		CHECK(isfinite(nav.yaw) && isfinite(nav.pitch));
	}
}

static void a_fling_slows_down_and_ends(void **state)
{
	struct navigator nav;
	int steps = 0;

	(void)state;
	navigator_init(&nav, &hall);
	navigator_grab(&nav, pivot);
	navigator_fling(&nav, 900, 0);
	while (navigator_step(&nav, 16, HEIGHT_PX))
		CHECK(++steps < 400);
	CHECK(steps > 20);
	navigator_fling(&nav, 900, 0);
	navigator_grab(&nav, pivot);
	CHECK(!navigator_step(&nav, 16, HEIGHT_PX));
}

static void a_flight_ends_where_it_was_sent_the_short_way_round(void **state)
{
	const float eye[3] = { -50, -3, 12 }, target[3] = { 0, 0, 8 };
	struct navigator nav;
	struct camera camera;

	(void)state;
	navigator_init(&nav, &hall);
	nav.yaw += 2 * (float)M_PI; /* turned once around before */
	navigator_fly(&nav, eye, target, 800);
	while (navigator_step(&nav, 16, HEIGHT_PX))
		CHECK(fabsf(nav.yaw - 2 * (float)M_PI) < 0.2f);
	CHECK(vec_distance(nav.eye_m, eye) < 1e-3f);
	navigator_camera(&nav, &camera);
	CHECK(camera.near_m > 0 && camera.far_m > 100);
}

/* A temple of one hollow box, 20 m wide and high, with walls and a roof of 2 m and a door in the
 * south; and a cell beside it that no way leads out of. */
static bool temple(const int32_t place[3])
{
	const int32_t x = place[0] - 32, y = place[1] - 32, z = place[2];
	const int32_t far = x * x > y * y ? x * x : y * y;
	const bool door = x > -3 && x < 3 && y < 0 && z < 6;
	const bool cell = x > 14 && x < 20 && y > 14 && y < 20 && z < 6;

	return z < 1 || (cell && !(x == 17 && y == 17 && z == 3)) ||
	       (far <= 100 && z < 20 && (far > 64 || z >= 18) && !door);
}

static struct solid built;

static const struct solid *solid_of_temple(void *data)
{
	(void)data;
	return &built;
}

static float reach_in_temple(void *data, const float from[3], const float direction[3], float most,
			     int *axis)
{
	(void)data;
	return solid_reach(&built, from, direction, most, axis);
}

static int build_temple(void **state)
{
	(void)state;
	solid_example_init(&built, 6, 1, (const float[3]){ -32, -32, -0.8f }, temple);
	return 0;
}

static int raze_temple(void **state)
{
	(void)state;
	solid_finish(&built);
	return 0;
}

static struct navigator_options at_temple(void)
{
	struct navigator_options options = hall;

	options.reach = reach_in_temple;
	options.solid = solid_of_temple;
	return options;
}

static const float middle[3] = { 0, 0, 8 };

/* From each side to the opposite one, and from each into the temple and out of it. */
static void a_flight_leads_round_what_is_in_the_way(void **state)
{
	const struct navigator_options options = at_temple();
	int longer = 0;

	(void)state;
	for (int i = 0; i < 48; i++) {
		const float turn = (float)(i % 16) * 0.37f, far = i < 16 ? 18 : 40;
		const float from[3] = { far * cosf(turn), far * sinf(turn), i % 3 ? 2 : 15 };
		const float across[3] = { -from[0], -from[1], i % 4 ? 1.8f : 12 };
		const float within[3] = { 2, 3, 4 };
		const float *to = i < 32 ? across : within;
		struct navigator nav;

		navigator_init(&nav, &options);
		navigator_look(&nav, from, middle);
		for (int back = 0; back < 2; back++) {
			navigator_fly(&nav, back ? from : to, middle, 900);
			while (navigator_step(&nav, 16, HEIGHT_PX)) {
				CHECK(solid_is_free(&built, nav.eye_m));
				longer += nav.flight_ms > 910;
			}
			CHECK(vec_distance(nav.eye_m, back ? from : to) < 1e-3f);
		}
	}
	CHECK(longer > 0);
}

/* Where no way leads to, and within stone. */
static void a_flight_without_a_way_is_over_at_once(void **state)
{
	const struct navigator_options options = at_temple();
	const float in_cell[3] = { 17.5f, 17.5f, 2.7f }, in_wall[3] = { -9.3f, 0, 5 };
	struct navigator nav;

	(void)state;
	navigator_init(&nav, &options);
	navigator_fly(&nav, in_cell, middle, 900);
	CHECK(nav.flight_left_ms <= 1);
	while (navigator_step(&nav, 16, HEIGHT_PX))
		;
	CHECK(vec_distance(nav.eye_m, in_cell) < 1e-3f);
	navigator_fly(&nav, hall.home_eye_m, middle, 900);
	CHECK(navigator_step(&nav, 16, HEIGHT_PX));
	CHECK(vec_distance(nav.eye_m, hall.home_eye_m) < 1e-3f);
	navigator_fly(&nav, in_wall, middle, 900);
	while (navigator_step(&nav, 16, HEIGHT_PX))
		CHECK(solid_is_free(&built, nav.eye_m));
	CHECK(vec_distance(nav.eye_m, in_wall) < 2);
}

/* A pose of the content, or what is left of the release before. */
static void an_eye_in_stone_comes_out(void **state)
{
	const struct navigator_options options = at_temple();
	const float in_wall[3] = { -9.3f, 0, 5 };
	struct navigator nav;

	(void)state;
	navigator_init(&nav, &options);
	navigator_look(&nav, in_wall, middle);
	navigator_turn(&nav, 3, 0, HEIGHT_PX);
	CHECK(solid_is_free(&built, nav.eye_m) && vec_distance(nav.eye_m, in_wall) < 2);
	navigator_look(&nav, in_wall, middle);
	navigator_pinch(&nav, 1, 1, 0, 0, HEIGHT_PX);
	CHECK(solid_is_free(&built, nav.eye_m) && vec_distance(nav.eye_m, in_wall) < 2);
}

static void must_be_free(void *data, const struct navigator *nav)
{
	(void)data;
	CHECK(solid_is_free(&built, nav->eye_m));
}

static void no_hand_brings_an_eye_into_stone_or_holds_it_there(void **state)
{
	const struct navigator_options options = at_temple();
	struct random_hand hand = {
		.seed = 9, .low_m = { -15, -15, 0 }, .high_m = { 15, 15, 20 }, .look = must_be_free
	};
	float was[3];
	struct navigator nav;
	int within = 0, stuck = 0;

	(void)state;
	navigator_init(&nav, &options);
	for (int i = 0; i < 2000; i++) {
		vec_copy(was, nav.eye_m);
		random_hand_play(&hand, &nav);
		within += fabsf(nav.eye_m[0]) < 8 && fabsf(nav.eye_m[1]) < 8 && nav.eye_m[2] < 17;
		/* Of so many gestures one leads away from any place. */
		stuck = vec_distance(was, nav.eye_m) > 0.01f ? 0 : stuck + 1;
		CHECK(stuck < 12);
	}
	CHECK(within > 50);
}

/* A hand that pushes against a wall at a slant goes along it. */
static void an_eye_slides_along_a_wall(void **state)
{
	const struct navigator_options options = at_temple();
	const float before_wall[3] = { -12, -4, 5 }, ahead[3] = { -12, 30, 5 };
	struct navigator nav;

	(void)state;
	navigator_init(&nav, &options);
	navigator_look(&nav, before_wall, ahead);
	navigator_grab(&nav, (const float[3]){ 0, 4, 5 });
	navigator_pinch(&nav, 4, 0, 0, 0, HEIGHT_PX);
	CHECK(nav.eye_m[0] < -10 && nav.eye_m[1] > 1);
	CHECK(solid_is_free(&built, nav.eye_m));
}

static void a_step_is_no_reason_for_a_detour(void **state)
{
	const struct navigator_options options = at_temple();
	const float here[3] = { -11.02f, 0, 5 }, there[3] = { -11.02f, 0.01f, 5 };
	struct navigator nav;

	(void)state;
	navigator_init(&nav, &options);
	navigator_look(&nav, here, middle);
	navigator_fly(&nav, there, middle, 800);
	while (navigator_step(&nav, 16, HEIGHT_PX))
		CHECK(vec_distance(nav.eye_m, here) < 0.05f);
	CHECK(vec_distance(nav.eye_m, there) < 1e-3f);
}

static void where_nothing_is_in_the_way_a_flight_is_straight(void **state)
{
	const struct navigator_options options = at_temple();
	const float eye[3] = { -50, -30, 12 };
	struct navigator nav;
	float along[3], from[3], off[3];

	(void)state;
	navigator_init(&nav, &options);
	vec_copy(from, nav.eye_m);
	navigator_fly(&nav, eye, middle, 800);
	CHECK(fabsf(nav.flight_ms - 800) < 1);
	vec_sub(along, eye, from);
	while (navigator_step(&nav, 16, HEIGHT_PX)) {
		vec_sub(off, nav.eye_m, from);
		vec_cross(off, off, along);
		CHECK(vec_length(off) / vec_length(along) < 1e-3f);
	}
}

/* Of a release without an octree only rays are known. */
static void without_an_octree_a_flight_is_straight_or_over_at_once(void **state)
{
	const float eye[3] = { -50, -3, 12 }, behind[3] = { 0, 0, 8 };
	struct navigator_options options = hall;
	struct navigator nav;

	(void)state;
	options.reach = wall_at_minus_21;
	navigator_init(&nav, &options);
	navigator_fly(&nav, eye, middle, 800);
	CHECK(nav.flight_left_ms >= 800);
	navigator_fly(&nav, behind, middle, 800);
	CHECK(nav.flight_left_ms <= 1 && navigator_step(&nav, 16, HEIGHT_PX));
	CHECK(vec_distance(nav.eye_m, behind) < 1e-3f);
}

static void knows_whether_somebody_moved_it_since_a_flight(void **state)
{
	const float eye[3] = { -50, -3, 12 }, target[3] = { 0, 0, 8 };
	struct navigator nav;

	(void)state;
	navigator_init(&nav, &hall);
	CHECK(!navigator_is_left_alone(&nav)); /* there was none */
	navigator_fly(&nav, eye, target, 800);
	navigator_step(&nav, 16, HEIGHT_PX);
	CHECK(navigator_is_left_alone(&nav));
	while (navigator_step(&nav, 16, HEIGHT_PX))
		;
	CHECK(navigator_is_left_alone(&nav));
	navigator_grab(&nav, target); /* a tap is no look elsewhere */
	CHECK(navigator_is_left_alone(&nav));
	navigator_turn(&nav, 30, 0, HEIGHT_PX);
	CHECK(!navigator_is_left_alone(&nav));
	navigator_fly(&nav, eye, target, 800);
	navigator_step(&nav, 16, HEIGHT_PX);
	navigator_grab(&nav, target); /* a touch stops it on its way */
	CHECK(!navigator_is_left_alone(&nav));
}

static float wall_before_bunny(void *data, const float from[3], const float direction[3],
			       float most, int *axis)
{
	float d = direction[0] > 0 ? (-0.0848f - from[0]) / direction[0] : INFINITY;

	(void)data;
	*axis = -1;
	return d >= 0 && d < most ? d : INFINITY;
}

/* What a hand can hold is looked at from a finger's breadth, and not cut open by the near plane. */
static void a_small_model_is_approached_as_near_as_a_large_one(void **state)
{
	const struct navigator_options bunny = { .box_min_m = { -0.08f, -0.06f, 0.03f },
						 .box_max_m = { 0.08f, 0.06f, 0.19f },
						 .home_eye_m = { -0.5f, 0, 0.15f },
						 .home_target_m = { 0, 0, 0.11f },
						 .fov_deg = 45,
						 .reach = wall_before_bunny };
	const float snout[3] = { -0.08f, 0, 0.1f };
	struct navigator nav;
	struct camera camera;

	(void)state;
	navigator_init(&nav, &bunny);
	navigator_grab(&nav, snout);
	for (int i = 0; i < 60; i++)
		navigator_pinch(&nav, 1.3f, 0, 0, 0, HEIGHT_PX);
	navigator_camera(&nav, &camera);
	CHECK(vec_distance(nav.eye_m, snout) < 0.0055f);
	CHECK(camera.near_m < vec_distance(nav.eye_m, snout));
	for (int i = 0; i < 60; i++)
		navigator_turn(&nav, 0, -40, HEIGHT_PX);
	CHECK(nav.eye_m[2] > 0.03f);
}

static void going_home_leads_to_where_it_began_however_far(void **state)
{
	struct navigator_options options = hall;
	struct navigator nav;

	(void)state;
	options.home_eye_m[0] = -130; /* beyond two and a half half diagonals */
	navigator_init(&nav, &options);
	navigator_grab(&nav, pivot);
	navigator_pinch(&nav, 3, 0, 0, 0, HEIGHT_PX);
	navigator_fly(&nav, options.home_eye_m, options.home_target_m, 800);
	while (navigator_step(&nav, 16, HEIGHT_PX))
		;
	CHECK(vec_distance(nav.eye_m, options.home_eye_m) < 1e-3f);
}

/* On foot: fingers look around and step, and nothing lifts anybody off the floor. */
static void on_foot_one_stays_on_the_floor(void **state)
{
	const struct navigator_options options = at_temple();
	const float floor_m[3] = { -14, -12, 1 }, inside_m[3] = { 2, 3, 1 };
	struct navigator nav;
	float was[3];

	(void)state;
	navigator_init(&nav, &options);
	navigator_set_on_foot(&nav, true);
	vec_copy(was, nav.eye_m);
	navigator_grab(&nav, middle);
	navigator_pinch(&nav, 1.1f, 0, 0, 0, HEIGHT_PX); /* in the air as ever: nearer, not down */
	CHECK(nav.eye_m[2] > was[2] / 2 && vec_distance(nav.eye_m, was) > 0.1f);
	CHECK(navigator_walk(&nav, floor_m)); /* from the air: a flight */
	while (navigator_step(&nav, 16, HEIGHT_PX))
		CHECK(solid_is_free(&built, nav.eye_m));
	CHECK(hypotf(nav.eye_m[0] - floor_m[0], nav.eye_m[1] - floor_m[1]) < 1);
	vec_copy(was, nav.eye_m);
	navigator_grab(&nav, middle);
	navigator_turn(&nav, 300, 100, HEIGHT_PX);
	navigator_fling(&nav, 900, 0);
	while (navigator_step(&nav, 16, HEIGHT_PX))
		;
	CHECK(vec_distance(nav.eye_m, was) == 0);
	navigator_look(&nav, was, (const float[3]){ was[0] + 1, was[1], was[2] });
	navigator_pinch(&nav, 1.5f, 0, 0, 0, HEIGHT_PX);
	CHECK(nav.eye_m[0] > was[0] + 0.5f && fabsf(nav.eye_m[1] - was[1]) < 0.01f);
	CHECK(navigator_walk(&nav, inside_m)); /* round the temple and through its door */
	vec_copy(was, nav.eye_m);
	while (navigator_step(&nav, 16, HEIGHT_PX)) {
		CHECK(solid_is_free(&built, nav.eye_m) && fabsf(nav.eye_m[2] - was[2]) < 0.5f);
		CHECK(vec_distance(nav.eye_m, was) < 40);
	}
	CHECK(hypotf(nav.eye_m[0] - inside_m[0], nav.eye_m[1] - inside_m[1]) < 1.5f);
	for (int i = 0; i < 500; i++) {
		navigator_pinch(&nav, i % 2 ? 0.7f : 1.6f, (float)(i % 7) * 20, 0, 0.3f, HEIGHT_PX);
		CHECK(solid_is_free(&built, nav.eye_m) && nav.eye_m[2] < was[2] + 1);
	}
	navigator_set_on_foot(&nav, false);
	navigator_turn(&nav, 100, 0, HEIGHT_PX);
	CHECK(nav.eye_m[2] < 20);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(turning_keeps_the_touched_point_under_the_finger),
		cmocka_unit_test(a_finger_to_the_right_turns_the_model_to_the_right),
		cmocka_unit_test(parting_fingers_come_nearer_and_keep_the_point),
		cmocka_unit_test(panning_moves_the_point_with_the_fingers),
		cmocka_unit_test(never_passes_a_wall),
		cmocka_unit_test(stays_above_ground_and_near),
		cmocka_unit_test(a_fling_slows_down_and_ends),
		cmocka_unit_test(a_flight_ends_where_it_was_sent_the_short_way_round),
		cmocka_unit_test(a_flight_leads_round_what_is_in_the_way),
		cmocka_unit_test(a_step_is_no_reason_for_a_detour),
		cmocka_unit_test(where_nothing_is_in_the_way_a_flight_is_straight),
		cmocka_unit_test(a_flight_without_a_way_is_over_at_once),
		cmocka_unit_test(without_an_octree_a_flight_is_straight_or_over_at_once),
		cmocka_unit_test(an_eye_in_stone_comes_out),
		cmocka_unit_test(an_eye_slides_along_a_wall),
		cmocka_unit_test(no_hand_brings_an_eye_into_stone_or_holds_it_there),
		cmocka_unit_test(on_foot_one_stays_on_the_floor),
		cmocka_unit_test(knows_whether_somebody_moved_it_since_a_flight),
		cmocka_unit_test(a_small_model_is_approached_as_near_as_a_large_one),
		cmocka_unit_test(going_home_leads_to_where_it_began_however_far),
	};

	return cmocka_run_group_tests(tests, build_temple, raze_temple);
}
