/* Points of the glass and of the picture, on panels that hang in every way. */
#include "app/view/viewport.h"
#include "tests/check.h"

static struct viewport hung(int rotation_deg)
{
	return (struct viewport){ .panel_width_px = 1920,
				  .panel_height_px = 1080,
				  .rotation_deg = rotation_deg };
}

static void a_panel_on_its_side_is_as_wide_as_it_was_high(void **state)
{
	(void)state;
	for (int deg = 0; deg < 360; deg += 90) {
		const struct viewport viewport = hung(deg);
		const bool sideways = deg == 90 || deg == 270;

		CHECK(viewport_width_px(&viewport) == (sideways ? 1080 : 1920));
		CHECK(viewport_height_px(&viewport) == (sideways ? 1920 : 1080));
	}
}

static void a_point_comes_back_from_the_panel(void **state)
{
	(void)state;
	for (int deg = 0; deg < 360; deg += 90) {
		const struct viewport viewport = hung(deg);
		float x_px = 100, y_px = 40;

		viewport_to_panel(&viewport, &x_px, &y_px);
		CHECK(x_px >= 0 && x_px <= 1920 && y_px >= 0 && y_px <= 1080);
		viewport_from_panel(&viewport, &x_px, &y_px);
		CHECK(x_px == 100 && y_px == 40);
	}
}

/* Turned clockwise by a quarter, the picture's upper left corner is the panel's lower left. */
static void the_upper_left_corner_goes_round(void **state)
{
	static const float corners[4][2] = { { 0, 0 }, { 0, 1080 }, { 1920, 1080 }, { 1920, 0 } };

	(void)state;
	for (int i = 0; i < 4; i++) {
		const struct viewport viewport = hung(90 * i);
		float x_px = 0, y_px = 0;

		viewport_to_panel(&viewport, &x_px, &y_px);
		CHECK(x_px == corners[i][0] && y_px == corners[i][1]);
	}
}

/* The shift is right and up on the panel, whichever way the picture stands. */
static void a_finger_meets_the_shifted_picture(void **state)
{
	static const float seen[4][2] = { { 96, 43 }, { 97, 36 }, { 104, 37 }, { 103, 44 } };

	(void)state;
	for (int i = 0; i < 4; i++) {
		struct viewport viewport = hung(90 * i);
		float x_px = 100, y_px = 40;

		viewport.shift_px[0] = 4;
		viewport.shift_px[1] = 3;
		viewport_unshift(&viewport, &x_px, &y_px);
		CHECK(x_px == seen[i][0] && y_px == seen[i][1]);
	}
}

static void a_camera_gets_the_panel_and_keeps_its_pose(void **state)
{
	struct viewport viewport = hung(270);
	struct camera camera = { .eye_m = { 1, 2, 3 }, .fov_deg = 45 };

	(void)state;
	viewport.shift_px[0] = -2;
	viewport_set_camera(&viewport, &camera);
	CHECK(camera.width_px == 1920 && camera.height_px == 1080);
	CHECK(camera.rotation_deg == 270 && camera.shift_px[0] == -2);
	CHECK(camera.eye_m[1] == 2 && camera.fov_deg == 45);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_panel_on_its_side_is_as_wide_as_it_was_high),
		cmocka_unit_test(a_point_comes_back_from_the_panel),
		cmocka_unit_test(the_upper_left_corner_goes_round),
		cmocka_unit_test(a_finger_meets_the_shifted_picture),
		cmocka_unit_test(a_camera_gets_the_panel_and_keeps_its_pose),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
