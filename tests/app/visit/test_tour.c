/* A tour that is flown: where it halts it goes on, it flies what the pipeline judged, and ends. */
#include "app/visit/tour.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/view/navigator.h"
#include "geometry/vec.h"
#include "tests/check.h"

static const struct info_tour walk = {
	.id = "walk",
	.attract = true,
	.stop_count = 3,
	.stops = { { { 30, -40, 12 }, { 0, 0, 8 }, 5, 0, -1 },
		   { { 22, 1, 5 }, { 18, 0, 5 }, 4, 6, 2 },
		   { { 22, -18, 6 }, { 9, -14, 4 }, 3, 0, -1 } },
};
static const float diagonal_m = 60;

static struct tour tour;

static void flies_the_very_way_that_was_judged(void **state)
{
	static struct tour_path judged;
	struct tour_pose pose, expected;
	int64_t now_ms = 1000;

	(void)state;
	tour_way(&judged, &walk, diagonal_m);
	CHECK(judged.leg_count == 3); /* that of who is not there leads back */
	tour_begin(&tour, 4, &walk, true, diagonal_m, now_ms);
	CHECK(!tour_step(&tour, now_ms += 20, false, &pose) && tour_runs(&tour));
	CHECK(tour_wait_ms(&tour, now_ms) == 0);
	CHECK(tour_step(&tour, now_ms, true, &pose));
	for (int64_t ms = 0; ms < 2 * judged.duration_ms; ms += 20) {
		tour_path_pose(&judged, ms % judged.duration_ms, &expected);
		CHECK(memcmp(expected.eye_m, pose.eye_m, sizeof(pose.eye_m)) == 0);
		CHECK(memcmp(expected.target_m, pose.target_m, sizeof(pose.target_m)) == 0);
		CHECK(tour_step(&tour, now_ms += 20, true, &pose));
	}
	CHECK(tour_runs(&tour));
}

static void a_visitors_tour_ends_at_its_last_stop(void **state)
{
	struct tour_pose pose;
	int64_t now_ms = 1000, steps = 0;

	(void)state;
	tour_begin(&tour, 0, &walk, false, diagonal_m, now_ms);
	while (tour_runs(&tour) && ++steps < 100000)
		tour_step(&tour, now_ms += 20, true, &pose);
	CHECK(steps < 100000 && tour.state == TOUR_OFF);
	CHECK(vec_distance(pose.eye_m, walk.stops[2].eye_m) < 1e-3f);
	CHECK(!tour_step(&tour, now_ms += 20, true, &pose) && tour_wait_ms(&tour, now_ms) == -1);
}

static void goes_on_where_it_halted(void **state)
{
	struct tour_pose before = { 0 }, pose;
	int64_t now_ms = 1000, at_ms;

	(void)state;
	srand(3);
	tour_begin(&tour, 0, &walk, false, diagonal_m, now_ms);
	for (int trial = 0; trial < 20; trial++) {
		for (int i = rand() % 40; i >= 0; i--)
			tour_step(&tour, now_ms += 20, true, &before);
		if (!tour_runs(&tour))
			break;
		at_ms = tour.at_ms;
		tour_halt(&tour);
		CHECK(!tour_runs(&tour) && tour_wait_ms(&tour, now_ms) == -1);
		now_ms += rand() % 100000; /* however long it is looked around */
		CHECK(!tour_step(&tour, now_ms, true, &pose));
		tour_go_on(&tour);
		CHECK(!tour_step(&tour, now_ms += 500, false, &pose)); /* the eye comes back */
		CHECK(tour_step(&tour, now_ms += 500, true, &pose));
		CHECK(tour.at_ms == at_ms);
		if (trial > 0)
			CHECK(vec_distance(pose.eye_m, before.eye_m) < 1e-4f &&
			      vec_distance(pose.target_m, before.target_m) < 1e-3f);
	}
}

/* Halted while the eye still comes, it comes again; what does not run neither halts nor goes on. */
static void halts_and_goes_on_in_any_state(void **state)
{
	struct tour_pose pose;

	(void)state;
	tour_begin(&tour, 0, &walk, false, diagonal_m, 0);
	tour_halt(&tour);
	CHECK(tour.state == TOUR_HALTED);
	tour_go_on(&tour);
	CHECK(tour.state == TOUR_COMING && tour_step(&tour, 20, true, &pose));
	tour_go_on(&tour);
	CHECK(tour.state == TOUR_FLYING);
	tour_end(&tour);
	tour_halt(&tour);
	tour_go_on(&tour);
	CHECK(tour.state == TOUR_OFF);
}

/* A frame that took long is a step as any other; a rest, where nothing is drawn, is not. */
static void a_hiccup_is_no_jump(void **state)
{
	struct tour_pose before, pose;
	int64_t now_ms = 0;

	(void)state;
	tour_begin(&tour, 0, &walk, false, diagonal_m, now_ms);
	tour_step(&tour, now_ms, true, &before);
	CHECK(tour_wait_ms(&tour, now_ms) == 5000);
	CHECK(tour_step(&tour, now_ms += 5000, true, &pose) && tour.at_ms == 5000);
	for (int i = 0; i < 40; i++) {
		before = pose;
		CHECK(tour_step(&tour, now_ms += 700, true, &pose));
		CHECK(vec_distance(before.eye_m, pose.eye_m) < 0.8f);
	}
}

/* The pipeline's clearance is for the eye that this program has. */
static void no_near_plane_reaches_what_the_pipeline_lets_pass(void **state)
{
	(void)state;
	for (float size = 0.1f; size < 1000; size *= 1.3f) {
		const struct navigator_options options = {
			.box_max_m = { size, size, size / 2 },
			.home_eye_m = { 0, -2 * size, size },
			.fov_deg = 45,
		};
		const float widest = 21 / 9.0f, tangent = tanf(45 * (float)M_PI / 360);
		struct navigator nav;
		struct camera camera = { 0 };
		float corner_m;

		navigator_init(&nav, &options);
		navigator_camera(&nav, &camera);
		corner_m = camera.near_m * sqrtf(1 + tangent * tangent * (1 + widest * widest));
		CHECK(corner_m <= tour_path_clearance_m(navigator_diagonal_m(&nav)));
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(flies_the_very_way_that_was_judged),
		cmocka_unit_test(a_visitors_tour_ends_at_its_last_stop),
		cmocka_unit_test(goes_on_where_it_halted),
		cmocka_unit_test(halts_and_goes_on_in_any_state),
		cmocka_unit_test(a_hiccup_is_no_jump),
		cmocka_unit_test(no_near_plane_reaches_what_the_pipeline_lets_pass),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
