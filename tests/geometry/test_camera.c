#include <math.h>
#include <string.h>

#include "geometry/camera.h"
#include "tests/check.h"

static const struct camera looking_north = { .eye_m = { 1, 2, 3 },
					     .target_m = { 1, 12, 3 },
					     .up = { 0, 0, 1 },
					     .fov_deg = 90,
					     .near_m = 0.1f,
					     .far_m = 100,
					     .width_px = 200,
					     .height_px = 100 };

static bool near(float a, float b)
{
	return fabsf(a - b) < 2e-3f;
}

static void sees_where_analysis_says(void **state)
{
	const struct camera *camera = &looking_north;
	/* Half a metre right and a quarter above, one metre before the eye; 90 degrees high: a
	 * metre up is 50 pixels. */
	const float point[3] = { 1.5f, 3, 3.25f }, behind[3] = { 1, 1, 3 };
	float x, y;

	(void)state;
	CHECK(near(camera_px_per_radian(camera), 50) && near(camera_aspect(camera), 2));
	CHECK(camera_pixel(camera, point, &x, &y));
	CHECK(near(x, 125) && near(y, 37.5f));
	CHECK(!camera_pixel(camera, behind, &x, &y));
}

static void turns_with_the_panel(void **state)
{
	/* By 90 degrees clockwise the framebuffer's top points to the visitor's right and its left
	 * side up; the framebuffer is 100 wide and 200 high for a picture of 200 x 100. */
	static const float expected[4][2] = {
		{ 125, 37.5f }, { 37.5f, 75 }, { 75, 62.5f }, { 62.5f, 125 }
	};
	const float point[3] = { 1.5f, 3, 3.25f };

	(void)state;
	for (int quarter = 0; quarter < 4; quarter++) {
		struct camera camera = looking_north;
		float x, y;

		camera.rotation_deg = 90 * quarter;
		if (quarter % 2) {
			camera.width_px = 100;
			camera.height_px = 200;
		}
		CHECK(camera_pixel(&camera, point, &x, &y));
		CHECK(near(x, expected[quarter][0]) && near(y, expected[quarter][1]));
	}
}

static void casts_rays_through_pixels(void **state)
{
	(void)state;
	for (int deg = 0; deg < 360; deg += 90) {
		struct camera camera = looking_north;

		camera.target_m[0] = 5;
		camera.target_m[2] = -7;
		camera.rotation_deg = deg;
		for (float px = 5; px < 200; px += 31) {
			float direction[3], point[3], x, y;

			camera_ray(&camera, px, px / 2, direction);
			for (int i = 0; i < 3; i++)
				point[i] = camera.eye_m[i] + 17 * direction[i];
			CHECK(camera_pixel(&camera, point, &x, &y));
			CHECK(near(x, px) && near(y, px / 2));
		}
	}
}

static void looks_straight_down(void **state)
{
	struct camera camera = looking_north;
	float x, y, matrix[16];
	const float below[3] = { 1, 2, -4 };

	(void)state;
	memcpy(camera.target_m, below, sizeof(below));
	CHECK(camera_pixel(&camera, below, &x, &y));
	CHECK(near(x, 100) && near(y, 50));
	camera_matrix(&camera, matrix);
	for (int i = 0; i < 16; i++)
		CHECK(isfinite(matrix[i]));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(sees_where_analysis_says),
		cmocka_unit_test(turns_with_the_panel),
		cmocka_unit_test(casts_rays_through_pixels),
		cmocka_unit_test(looks_straight_down),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
