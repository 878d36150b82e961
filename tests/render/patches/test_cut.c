#include <math.h>
#include <string.h>

#include "render/patches/cut.h"
#include "tests/check.h"
#include "tests/render/patches/little_hierarchy.h"

static struct view view_from(float x, float y, float target_x)
{
	const struct camera camera = { .eye_m = { x, y, 0 },
				       .target_m = { target_x, 0, 0 },
				       .up = { 0, 0, 1 },
				       .fov_deg = 40,
				       .near_m = 0.1f,
				       .far_m = 1000,
				       .width_px = 1000,
				       .height_px = 1000 };
	struct view view;
	view_from_camera(&view, &camera);
	return view;
}

static void update(struct cut *cut, const struct view *view, const uint8_t *loaded,
		   const struct cut_options *options)
{
	cut_update(cut, view, loaded, options);
	cut_desire(cut, view, loaded, NULL, options);
}

static int set_up(void **state)
{
	static struct cut cut;
	for (uint32_t p = 0; p < 8; p++) {
		patches[p].triangle_count = 100;
		patches[p].centre_m[0] = p == 1 || p == 4 || p == 5 ? 20 : 0;
		patches[p].radius_m = 4;
		patches[p].cone_cos = -1;
	}
	*state = &cut;
	return cut_init(&cut, &hierarchy);
}

static int tear_down(void **state)
{
	cut_finish(*state);
	return 0;
}

static bool shows(const struct cut *cut, uint32_t patch)
{
	for (uint32_t i = 0; i < cut->patch_count; i++)
		if (cut->patches[i] == patch)
			return true;
	return false;
}

static void shows_nothing_before_the_top_group_is_there(void **state)
{
	struct cut *cut = *state;
	const struct cut_options options = { 1, 100000 };
	const uint8_t loaded[4] = { 0, 1, 1, 1 };
	struct view view = view_from(10, -60, 10);
	update(cut, &view, loaded, &options);
	CHECK(cut->patch_count == 0);
	CHECK(cut->want_count > 0 && cut->wants[0].group == 0);
}

static void coarser_patches_stand_in_for_what_is_not_loaded(void **state)
{
	struct cut *cut = *state;
	const struct cut_options options = { 1, 100000 };
	const uint8_t loaded[4] = { 1, 1, 0, 1 };
	struct view view = view_from(10, -60, 10);
	update(cut, &view, loaded, &options);
	/* Group 3 needs group 2, so it waits although it is loaded. */
	CHECK(cut->shown[1] && !cut->shown[2] && !cut->shown[3]);
	CHECK(shows(cut, 1) && shows(cut, 2) && shows(cut, 3) && cut->patch_count == 3);
	CHECK(cut->want_count == 1 && cut->wants[0].group == 2);
	CHECK(cut->wants[0].error_px > 1 && cut->wants[0].seen_px > 0);
}

static void refines_no_further_than_the_error_asks(void **state)
{
	struct cut *cut = *state;
	const uint8_t loaded[4] = { 1, 1, 1, 1 };
	struct view view = view_from(10, -60, 10);
	float error_px = cut_group_error_px(&groups[3], view.eye_m, view.focal_px);
	struct cut_options options = { error_px * 1.01f, 100000 };
	update(cut, &view, loaded, &options);
	CHECK(cut->shown[1] && cut->shown[2] && !cut->shown[3]);
	options.error_px = error_px * 0.99f;
	update(cut, &view, loaded, &options);
	CHECK(cut->shown[3] && shows(cut, 6) && !shows(cut, 2) && !shows(cut, 4));
}

static void stays_within_the_triangles(void **state)
{
	struct cut *cut = *state;
	const struct cut_options options = { 1, 300 };
	const uint8_t loaded[4] = { 1, 1, 1, 1 };
	struct view view = view_from(10, -60, 10);
	update(cut, &view, loaded, &options);
	CHECK(cut->triangle_count <= 300 && cut->triangle_count >= 200);
	CHECK(cut->shown[1] + cut->shown[2] == 1 && !cut->shown[3]);
}

/* The root group has 200 triangles; groups 1 and 2 add 100 each, group 3 none. */
static void meets_any_number_of_triangles(void **state)
{
	struct cut *cut = *state;
	const uint8_t loaded[4] = { 1, 1, 1, 1 };
	struct view view = view_from(10, -60, 10);
	for (uint32_t budget = 200; budget <= 600; budget++) {
		const struct cut_options options = { 0.001f, budget };
		update(cut, &view, loaded, &options);
		CHECK(cut->triangle_count <= budget);
		CHECK(cut->triangle_count + 100 > budget || cut->shown[3]);
	}
}

static void wants_only_what_is_in_sight(void **state)
{
	struct cut *cut = *state;
	const struct cut_options options = { 1, 100000 };
	const uint8_t loaded[4] = { 1, 0, 0, 0 };
	struct view view = view_from(40, -60, 40);
	update(cut, &view, loaded, &options);
	for (uint32_t i = 0; i < cut->want_count; i++)
		CHECK(cut->wants[i].group == 2);
	CHECK(cut->want_count == 1);
}

static void wants_only_what_shows_and_what_that_needs(void **state)
{
	struct cut *cut = *state;
	const struct cut_options options = { 1, 100000 };
	const uint8_t top[4] = { 1, 0, 0, 0 }, one[4] = { 1, 1, 0, 0 };
	float seen_px[8] = { 0, 500, -1, -1, -1, -1, -1, -1 };
	struct view view = view_from(10, -60, 10);
	cut_update(cut, &view, top, &options);
	cut_desire(cut, &view, top, seen_px, &options);
	/* Group 1 mends nothing that shows, but 3 mends some of 2's and needs it. */
	CHECK(cut->want_count == 3 && cut->wants[0].group == 1 && cut->wants[2].group == 3);
	CHECK(cut->wants[0].seen_px <= 0 && cut->wants[1].seen_px > 499);
	CHECK(cut->wants[2].seen_px > 100 && cut->wants[2].seen_px < 400);
	cut_update(cut, &view, one, &options);
	for (int p = 0; p < 8; p++)
		seen_px[p] = 0;
	seen_px[3] = 300; /* the finest there */
	cut_desire(cut, &view, one, seen_px, &options);
	CHECK(cut->want_count == 0);
}

static void every_cut_is_valid_from_everywhere(void **state)
{
	struct cut *cut = *state;
	for (int from = 0; from < 16 * 40; from++) {
		const uint8_t loaded[4] = { 1, from & 1, from >> 1 & 1, from >> 2 & 1 };
		const struct cut_options options = { 0.5f + (float)(from % 7),
						     250 + 50u * (uint32_t)(from % 9) };
		struct view view = view_from((float)(from % 40) - 10, -5 - (float)(from / 8), 10);
		update(cut, &view, loaded, &options);
		for (uint32_t g = 1; g < 4; g++)
			for (uint32_t on = 0; on < 4; on++)
				CHECK(!cut->shown[g] || !cut_depends(cut, g, on) || cut->shown[on]);
		for (uint32_t g = 0; g < 4; g++)
			CHECK(!cut->shown[g] || loaded[g]);
		/* Each surface once: patch 0's by itself or by group 1. */
		CHECK(shows(cut, 0) != (bool)cut->shown[1]);
		CHECK(shows(cut, 1) != (bool)cut->shown[2]);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(shows_nothing_before_the_top_group_is_there),
		cmocka_unit_test(coarser_patches_stand_in_for_what_is_not_loaded),
		cmocka_unit_test(refines_no_further_than_the_error_asks),
		cmocka_unit_test(stays_within_the_triangles),
		cmocka_unit_test(meets_any_number_of_triangles),
		cmocka_unit_test(wants_only_what_is_in_sight),
		cmocka_unit_test(wants_only_what_shows_and_what_that_needs),
		cmocka_unit_test(every_cut_is_valid_from_everywhere),
	};
	return cmocka_run_group_tests(tests, set_up, tear_down);
}
