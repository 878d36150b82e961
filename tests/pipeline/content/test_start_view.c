#include "pipeline/content/start_view.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "geometry/camera.h"
#include "geometry/vec.h"
#include "tests/check.h"

/* The farthest of the box's corners from the picture's middle: 1 is its border. */
static float fills(const float low[3], const float high[3])
{
	struct camera camera = { .up = { 0, 0, 1 },
				 .fov_deg = START_VIEW_FOV_DEG,
				 .near_m = 0.001f,
				 .far_m = 1e5f,
				 .width_px = 1200,
				 .height_px = (int)(1200 / START_VIEW_ASPECT) };
	float most = 0;

	start_view(camera.eye_m, camera.target_m, low, high);
	for (unsigned corner = 0; corner < 8; corner++) {
		float at[3], x, y;

		for (int i = 0; i < 3; i++)
			at[i] = corner >> i & 1 ? high[i] : low[i];
		CHECK(camera_pixel(&camera, at, &x, &y)); /* before the eye */
		most = fmaxf(most, fmaxf(fabsf(x / 600 - 1), fabsf(y / 450 - 1)));
	}
	return most;
}

static void the_whole_model_is_in_the_picture_and_fills_it(void **state)
{
	static const struct {
		float low[3], high[3];
	} boxes[] = {
		{ { -21, -21, 0 }, { 21, 21, 18 } },                          /* a temple */
		{ { -0.33f, -0.33f, 0.16f }, { 0.45f, 0.28f, 2.33f } },       /* a statue */
		{ { -0.095f, -0.059f, 0.033f }, { 0.061f, 0.062f, 0.187f } }, /* a bunny */
		{ { 225, -388, -605 }, { 1156, 145, 991 } }, /* one in mm, said to be m */
		{ { -100, -1, 0 }, { 100, 1, 3 } },          /* a wall */
	};

	(void)state;
	for (size_t i = 0; i < sizeof(boxes) / sizeof(boxes[0]); i++) {
		float most = fills(boxes[i].low, boxes[i].high);

		CHECK(most < 0.96f);
		CHECK(most > 0.94f);
	}
}

static void begins_in_front_and_above(void **state)
{
	float eye[3], target[3];

	(void)state;
	start_view(eye, target, (float[]){ 0, 0, 0 }, (float[]){ 2, 2, 2 });
	CHECK(target[0] == 1 && target[1] == 1 && target[2] == 1);
	CHECK(eye[1] < -1 && eye[2] > 1);
}

static void a_box_without_extent_is_seen_from_somewhere(void **state)
{
	float eye[3], target[3];
	const float at[3] = { 5, 6, 7 };

	(void)state;
	start_view(eye, target, at, at);
	CHECK(memcmp(target, at, sizeof(at)) == 0);
	CHECK(fabsf(vec_distance(eye, target) - 1) < 1e-5f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_whole_model_is_in_the_picture_and_fills_it),
		cmocka_unit_test(begins_in_front_and_above),
		cmocka_unit_test(a_box_without_extent_is_seen_from_somewhere),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
