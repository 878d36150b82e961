/* The eye's way while nobody is there. */
#include "app/visit/attract_camera.h"

#include <math.h>

#include "base/compiler.h"
#include "tests/check.h"

static const float box_min[3] = { -30, -20, 0 }, box_max[3] = { 30, 20, 40 };

static float from_axis(const float p[3])
{
	return hypotf(p[0], p[1]);
}

static void rests_where_the_release_begins(void **state)
{
	const float home[3] = { 30, -70, 18 }, target[3] = { 1, 2, 12 };
	struct attract_camera attract;
	float eye[3], at[3];

	(void)state;
	attract_camera_init(&attract, box_min, box_max, home, target);
	CHECK(!attract_camera_pose(&attract, ATTRACT_CAMERA_REST_MS, eye, at) &&
	      attract_camera_rest_ms(0) == ATTRACT_CAMERA_REST_MS);
	for (int i = 0; i < 3; i++)
		CHECK(fabsf(eye[i] - home[i]) < 1e-4f && fabsf(at[i] - target[i]) < 1e-4f);
}

static void goes_round_without_a_jump_and_comes_back(void **state)
{
	const float home[3] = { 30, -70, 18 }, target[3] = { 1, 2, 12 };
	const int64_t round_ms =
		(int64_t)ATTRACT_CAMERA_PLACES * (ATTRACT_CAMERA_REST_MS + ATTRACT_CAMERA_MOVE_MS);
	float before[3], eye[3], at[3], farthest = 0;
	struct attract_camera attract;

	(void)state;
	attract_camera_init(&attract, box_min, box_max, home, target);
	attract_camera_pose(&attract, 0, before, at);
	for (int64_t ms = 0; ms <= round_ms; ms += 20) {
		const bool moves = attract_camera_pose(&attract, ms, eye, at);
		const float step = hypotf(eye[0] - before[0], eye[1] - before[1]);

		CHECK(step < 0.2f && moves == (attract_camera_rest_ms(ms) == 0 && step > 0));
		CHECK(fabsf(from_axis(eye) - from_axis(home)) < 1e-2f);
		farthest = fmaxf(farthest, hypotf(eye[0] - home[0], eye[1] - home[1]));
		for (int i = 0; i < 3; i++)
			before[i] = eye[i];
	}
	CHECK(farthest > 2 * from_axis(home) * 0.99f);
	CHECK(hypotf(eye[0] - home[0], eye[1] - home[1]) < 1e-2f);
}

static void stays_out_of_the_model_where_the_release_begins_inside(void **state)
{
	static const float homes[][3] = { { 1, 2, 3 }, { 0, 0, 100 }, { 25, 0, 2 } };
	const float target[3] = { 2, 2, 3 };
	struct attract_camera attract;
	float eye[3], at[3];

	(void)state;
	for (size_t h = 0; h < ARRAY_COUNT(homes); h++) {
		attract_camera_init(&attract, box_min, box_max, homes[h], target);
		for (int64_t ms = 0; ms < 200000; ms += 500) {
			attract_camera_pose(&attract, ms, eye, at);
			CHECK(from_axis(eye) > hypotf(30, 20));
			CHECK(eye[2] >= 20 && from_axis(at) < 1 && at[2] > 1);
		}
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(rests_where_the_release_begins),
		cmocka_unit_test(goes_round_without_a_jump_and_comes_back),
		cmocka_unit_test(stays_out_of_the_model_where_the_release_begins_inside),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
