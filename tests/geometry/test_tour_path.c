/* The way of a tour: through its stops, evenly, and never back in time. */
#include "geometry/tour_path.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/compiler.h"
#include "geometry/vec.h"
#include "tests/check.h"

static const struct tour_view four[] = {
	{ { 30, -40, 12 }, { 0, 0, 8 }, 5, 0, false },
	{ { 35, 0, 9 }, { 18, 0, 5 }, 0, 0, false },
	{ { 22, 1, 5 }, { 18, 0, 5 }, 4, 6, false },
	{ { 22, -18, 6 }, { 9, -14, 4 }, 3, 0, false },
};
static const float diagonal_m = 60;

static float between(const float a[3], const float b[3])
{
	return vec_distance(a, b);
}

static float angle(const struct tour_pose *a, const struct tour_pose *b)
{
	float from[3], to[3];

	vec_sub(from, a->target_m, a->eye_m);
	vec_sub(to, b->target_m, b->eye_m);
	return acosf(fminf(vec_dot(from, to) / (vec_length(from) * vec_length(to)), 1));
}

static float looks_off(const struct tour_pose *pose, const struct tour_view *stop)
{
	float from[3], to[3];

	vec_sub(from, pose->target_m, pose->eye_m);
	vec_sub(to, stop->target_m, stop->eye_m);
	return acosf(fminf(vec_dot(from, to) / (vec_length(from) * vec_length(to)), 1));
}

static void passes_through_every_stop(void **state)
{
	static struct tour_path path;

	(void)state;
	for (int closed = 0; closed < 2; closed++) {
		float nearest[4] = { 99, 99, 99, 99 };
		struct tour_pose pose;

		tour_path_init(&path, four, 4, closed, diagonal_m);
		for (int64_t ms = 0; ms <= path.duration_ms; ms += 5) {
			tour_path_pose(&path, ms, &pose);
			for (int i = 0; i < 4; i++) {
				float off = between(pose.eye_m, four[i].eye_m);

				if (off < nearest[i])
					nearest[i] = off;
				/* Where it stays it is, and looks as it was told to. */
				if (!pose.moves && pose.stop == (uint32_t)i)
					CHECK(off < 1e-3f && looks_off(&pose, &four[i]) < 2e-3f);
			}
		}
		for (int i = 0; i < 4; i++)
			CHECK(nearest[i] < 0.03f);
	}
}

/* Of the time that its author reads: stays, told and untold travels. */
static void takes_the_time_it_was_given(void **state)
{
	static struct tour_path path;
	struct tour_pose pose;
	int64_t moves_ms = 0;
	float leg_m[2];

	(void)state;
	tour_path_init(&path, four, 4, false, diagonal_m);
	CHECK(path.leg_count == 3 && path.run_count == 2);
	leg_m[0] = tour_path_leg_m(&path, 0);
	leg_m[1] = tour_path_leg_m(&path, 2);
	CHECK(path.runs[0].begin_ms == 5000);
	/* An untold leg: 5 % of the diagonal a second. */
	CHECK(llabs(path.runs[0].move_ms - (int64_t)((leg_m[0] / 3 + 6) * 1000)) <= 1);
	CHECK(path.runs[1].begin_ms == 5000 + path.runs[0].move_ms + 4000);
	CHECK(llabs(path.runs[1].move_ms - (int64_t)(leg_m[1] / 3 * 1000)) <= 1);
	CHECK(path.duration_ms == path.runs[1].begin_ms + path.runs[1].move_ms + 3000);
	for (int64_t ms = 0; ms < path.duration_ms; ms++) {
		tour_path_pose(&path, ms, &pose);
		moves_ms += pose.moves;
	}
	CHECK(moves_ms == path.runs[0].move_ms + path.runs[1].move_ms);
}

/* Whatever the stops: no jump in place, direction or speed, stops in their order, and never
 * backwards on the way. */
static void never_jumps_and_never_goes_back(void **state)
{
	static struct tour_path path;

	(void)state;
	srand(5);
	for (int trial = 0; trial < 200; trial++) {
		struct tour_view stops[12];
		const uint32_t count = 2 + (uint32_t)rand() % 11;
		const bool closed = trial % 2;
		struct tour_pose before, pose;
		float step_before = 0;

		for (uint32_t i = 0; i < count; i++) {
			for (int k = 0; k < 3; k++) {
				stops[i].eye_m[k] = (float)(rand() % 6000) / 100;
				stops[i].target_m[k] = (float)(rand() % 6000) / 100 + 0.005f;
			}
			stops[i].stay_s = i == 0 || i == count - 1 || rand() % 2 ? 2 : 0;
			stops[i].travel_s = 0;
			stops[i].is_even = false;
		}
		tour_path_init(&path, stops, count, closed, diagonal_m);
		tour_path_pose(&path, 0, &before);
		for (int64_t ms = 20; ms <= path.duration_ms; ms += 20) {
			float step;

			tour_path_pose(&path, ms, &pose);
			step = between(pose.eye_m, before.eye_m);
			/* 3 m/s and 0.5 rad/s, at most half as much again in the middle of a run.
			 */
			CHECK(step < 0.1f && angle(&pose, &before) < 0.02f);
			CHECK(fabsf(step - step_before) < 0.05f);
			CHECK(fabsf(between(pose.eye_m, pose.target_m) - 1) < 1e-3f);
			CHECK(pose.stop == before.stop || pose.stop == (before.stop + 1) % count);
			before = pose;
			step_before = step;
		}
		CHECK(!pose.moves || closed);
		CHECK(between(pose.eye_m, stops[closed ? 0 : count - 1].eye_m) < 0.1f);
	}
}

static void a_closed_way_begins_where_it_ends(void **state)
{
	static struct tour_path path;
	struct tour_pose first, last;

	(void)state;
	tour_path_init(&path, four, 4, true, diagonal_m);
	tour_path_pose(&path, 0, &first);
	tour_path_pose(&path, path.duration_ms - 1, &last);
	CHECK(between(first.eye_m, last.eye_m) < 0.01f && angle(&first, &last) < 2e-3f);
}

/* Two stops at one place: the eye only turns, the short way. */
static void turns_on_the_spot(void **state)
{
	static const struct tour_view spot[] = {
		{ { 5, 5, 5 }, { 4, 5.2f, 5 }, 1, 0, false },
		{ { 5, 5, 5 }, { 4, 4.8f, 5 }, 1, 0, false }, /* across the turn of the angle */
	};
	static struct tour_path path;
	struct tour_pose pose;

	(void)state;
	tour_path_init(&path, spot, 2, false, diagonal_m);
	for (int64_t ms = 0; ms <= path.duration_ms; ms += 20) {
		tour_path_pose(&path, ms, &pose);
		CHECK(between(pose.eye_m, spot[0].eye_m) < 1e-3f);
		CHECK(pose.target_m[0] < 4.1f);
	}
	CHECK(looks_off(&pose, &spot[1]) < 2e-3f);
}

/* Legs of 3, 0.5 and 7 seconds on straight lines, then one without a time, which is flown as ever.
 */
static void even_legs_keep_their_times(void **state)
{
	static const struct tour_view stops[] = {
		{ { 0, 0, 5 }, { 0, 9, 5 }, 2, 0, false },
		{ { 30, 0, 5 }, { 30, 9, 5 }, 0, 3, true },
		{ { 30, 4, 5 }, { 30, 13, 5 }, 1.5f, 0.5f, true },
		{ { 30, 4, 12 }, { 39, 4, 12 }, 0, 7, true },
		{ { 20, 4, 12 }, { 29, 4, 12 }, 1, 0, false },
	};
	/* When each leg begins. */
	static const int64_t begins_ms[] = { 2000, 5000, 7000, 14000 };
	static struct tour_path path;
	struct tour_pose pose, before;

	(void)state;
	tour_path_init(&path, stops, 5, false, diagonal_m);
	CHECK(path.run_count == 4);
	for (uint32_t leg = 0; leg < 3; leg++) {
		const int64_t travel_ms = llroundf(stops[leg + 1].travel_s * 1000);

		CHECK(path.runs[leg].begin_ms == begins_ms[leg] &&
		      path.runs[leg].move_ms == travel_ms);
		for (int64_t ms = 0; ms <= travel_ms; ms += 10) {
			float expected[3];

			vec_sub(expected, stops[leg + 1].eye_m, stops[leg].eye_m);
			vec_add_scaled(expected, stops[leg].eye_m, (float)ms / (float)travel_ms,
				       expected);
			tour_path_pose(&path, begins_ms[leg] + ms, &pose);
			CHECK(between(pose.eye_m, expected) < 1e-3f);
			CHECK(pose.moves || ms == travel_ms);
		}
	}
	/* A quarter turn in 7 seconds is even too. */
	tour_path_pose(&path, 7000, &before);
	tour_path_pose(&path, 7000 + 1400, &pose);
	CHECK(fabsf(angle(&before, &pose) - (float)M_PI / 10) < 2e-3f);
	CHECK(path.runs[3].begin_ms == 14000 &&
	      llabs(path.runs[3].move_ms - (int64_t)(tour_path_leg_m(&path, 3) / 3 * 1000)) <= 1);
	tour_path_pose(&path, 14000 + 333, &pose);
	CHECK(between(pose.eye_m, stops[3].eye_m) < 0.4f); /* it begins slowly */
}

static void tells_how_long_it_rests(void **state)
{
	static struct tour_path path;
	struct tour_pose pose;

	(void)state;
	tour_path_init(&path, four, 4, false, diagonal_m);
	CHECK(tour_path_rest_ms(&path, 0) == 5000 && tour_path_rest_ms(&path, 4999) == 1);
	for (int64_t ms = 0; ms < path.duration_ms; ms += 7) {
		const int64_t rest = tour_path_rest_ms(&path, ms);

		tour_path_pose(&path, ms, &pose);
		CHECK((rest == 0) == pose.moves);
		if (rest > 1) {
			tour_path_pose(&path, ms + rest - 1, &pose);
			CHECK(!pose.moves);
		}
	}
	CHECK(tour_path_rest_ms(&path, path.duration_ms) == 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(passes_through_every_stop),
		cmocka_unit_test(takes_the_time_it_was_given),
		cmocka_unit_test(never_jumps_and_never_goes_back),
		cmocka_unit_test(a_closed_way_begins_where_it_ends),
		cmocka_unit_test(turns_on_the_spot),
		cmocka_unit_test(even_legs_keep_their_times),
		cmocka_unit_test(tells_how_long_it_rests),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
