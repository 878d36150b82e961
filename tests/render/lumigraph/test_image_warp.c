/* Where the points of a reference picture go, and that its triangles hide each other as in space.
 */
#include <math.h>
#include <string.h>

#include "geometry/vec.h"
#include "render/lumigraph/image_warp.h"
#include "tests/check.h"

enum { SAMPLES_ACROSS = 64, SAMPLES_UP = 36 };
enum {
	DEPTHS_WIDTH = IMAGE_WARP_STEP * IMAGE_WARP_ACROSS,
	DEPTHS_HEIGHT = IMAGE_WARP_STEP * IMAGE_WARP_UP,
};

static struct image_warp warp;
static struct image_warp_reference reference;
static uint8_t depths[4 * IMAGE_WARP_DEPTHS];

static struct view view_from(float x, float y, float z, int rotation_deg)
{
	const struct camera camera = { .eye_m = { x, y, z },
				       .target_m = { x, y + 1, z },
				       .up = { 0, 0, 1 },
				       .fov_deg = 45,
				       .near_m = 0.1f,
				       .far_m = 100,
				       .width_px = rotation_deg ? 90 : 160,
				       .height_px = rotation_deg ? 160 : 90,
				       .rotation_deg = rotation_deg };
	struct view view;

	view_from_camera(&view, &camera);
	return view;
}

/* Returns what the depth buffer has, in 24 bits. */
static uint32_t depth_bits(const struct view *view, float depth_m)
{
	float to[3], z = view->clip[14];

	vec_scale(to, depth_m, view->forward);
	for (int k = 0; k < 3; k++)
		z += view->clip[4 * k + 2] * to[k];
	return (uint32_t)((z / depth_m + 1) / 2 * 16777215);
}

/* A picture of what depth_at says at a place of the view, each 0..1, y upwards; 0: nothing. Three
 * digits in base 255, as the program writes them. */
static void see(float (*depth_at)(float x, float y), int rotation_deg)
{
	reference.view = view_from(0, 0, 0, rotation_deg);
	for (int j = 0; j < DEPTHS_HEIGHT; j++) {
		for (int i = 0; i < DEPTHS_WIDTH; i++) {
			const float depth_m = depth_at(((float)i + 0.5f) / DEPTHS_WIDTH,
						       ((float)j + 0.5f) / DEPTHS_HEIGHT);
			uint8_t *at = depths + 4 * (j * DEPTHS_WIDTH + i);
			double left = depth_m > 0
					      ? depth_bits(&reference.view, depth_m) / 16777215.0
					      : 0.9999999;

			for (int k = 0; k < 3; k++) {
				left *= 255;
				at[k] = (uint8_t)left;
				left -= at[k];
			}
		}
	}
	image_warp_take_depths(&reference, depths);
}

static float a_wall(float x, float y)
{
	(void)x, (void)y;
	return 20;
}

/* Posts before a wall, and nothing above it. */
static float posts(float x, float y)
{
	if (y > 0.78f)
		return 0;
	return (int)(10 * x) % 2 ? 8 + 4.5f * y : 30;
}

static struct image_warp_point point_at(int column, int row)
{
	return warp.point[row * IMAGE_WARP_COLUMNS + column];
}

static void the_same_eye_sees_the_same_picture(void **state)
{
	(void)state;
	for (int turned = 0; turned <= 270; turned += 90) {
		see(posts, turned);
		image_warp_place(&warp, &reference, &reference.view);
		for (int n = 0; n < IMAGE_WARP_POINTS; n++) {
			const struct image_warp_point *p = &warp.point[n];
			const bool is_ring = fabsf(p->x) > 1.001f || fabsf(p->y) > 1.001f;

			if (is_ring)
				continue;
			CHECK(fabsf(p->x - (2 * p->u - 1)) < 1e-3f);
			CHECK(fabsf(p->y - (2 * p->v - 1)) < 1e-3f);
		}
	}
}

static void a_wall_moves_as_its_depth_says(void **state)
{
	(void)state;
	see(a_wall, 0);
	const struct view view = view_from(1, 2, 0.5f, 0);
	image_warp_place(&warp, &reference, &view);
	for (int row = 1; row <= IMAGE_WARP_UP + 1; row += 5) {
		for (int column = 1; column <= IMAGE_WARP_ACROSS + 1; column += 5) {
			const struct image_warp_point p = point_at(column, row);
			const float x_m = (2 * p.u - 1) * reference.view.tan_x * 20;
			const float z_m = (2 * p.v - 1) * reference.view.tan_y * 20;

			CHECK(fabsf(p.x - (x_m - 1) / (18 * view.tan_x)) < 2e-3f);
			CHECK(fabsf(p.y - (z_m - 0.5f) / (18 * view.tan_y)) < 2e-3f);
		}
	}
}

static void nothing_is_far_away_and_only_turns(void **state)
{
	(void)state;
	see(posts, 0);
	const struct view view = view_from(2, 0, 0, 0);
	image_warp_place(&warp, &reference, &view);
	const struct image_warp_point sky = point_at(IMAGE_WARP_ACROSS / 2, IMAGE_WARP_UP);
	CHECK(fabsf(sky.x - (2 * sky.u - 1)) < 1e-3f);
	CHECK(fabsf(reference.nearest_m - 8) < 0.1f);
}

/* ---- what hides what */

/* Returns the depth of a triangle at a place in clip space; 0: it is elsewhere. */
static float depth_in(const uint16_t corner[3], const float depth_m[], float x, float y)
{
	const struct image_warp_point *a = &warp.point[corner[0]], *b = &warp.point[corner[1]],
				      *c = &warp.point[corner[2]];
	const float area = (b->x - a->x) * (c->y - a->y) - (c->x - a->x) * (b->y - a->y);
	const float u = ((b->x - x) * (c->y - y) - (c->x - x) * (b->y - y)) / area;
	const float v = ((c->x - x) * (a->y - y) - (a->x - x) * (c->y - y)) / area;
	const float w = 1 - u - v;

	/* Both sides: a triangle of a reference may be seen from behind. */
	if (!(fabsf(area) > 1e-12f) || u < 0 || v < 0 || w < 0)
		return 0;
	return 1 / (u / depth_m[corner[0]] + v / depth_m[corner[1]] + w / depth_m[corner[2]]);
}

/* Returns the share of samples at which the last triangle is not the nearest one. */
static float wrongly_hidden(const struct view *view)
{
	static float depth_m[IMAGE_WARP_POINTS];
	static float last[SAMPLES_UP][SAMPLES_ACROSS], nearest[SAMPLES_UP][SAMPLES_ACROSS];
	uint32_t wrong = 0;

	memset(last, 0, sizeof(last));
	for (int n = 0; n < IMAGE_WARP_POINTS; n++) {
		float along = reference.depth_m[n], to[3];

		for (int k = 0; k < 3; k++)
			to[k] = reference.view.eye_m[k] + along * reference.view.forward[k] -
				view->eye_m[k];
		depth_m[n] = vec_dot(to, view->forward);
	}
	for (const uint16_t *t = warp.index; t < warp.index + IMAGE_WARP_INDICES; t += 3) {
		for (int j = 0; j < SAMPLES_UP; j++) {
			for (int i = 0; i < SAMPLES_ACROSS; i++) {
				const float x = 2 * ((float)i + 0.37f) / SAMPLES_ACROSS - 1;
				const float y = 2 * ((float)j + 0.41f) / SAMPLES_UP - 1;
				const float depth = depth_in(t, depth_m, x, y);

				if (depth <= 0)
					continue;
				if (last[j][i] == 0 || depth < nearest[j][i])
					nearest[j][i] = depth;
				last[j][i] = depth;
			}
		}
	}
	for (int j = 0; j < SAMPLES_UP; j++)
		for (int i = 0; i < SAMPLES_ACROSS; i++)
			wrong += last[j][i] == 0 || last[j][i] > 1.02f * nearest[j][i];
	return (float)wrong / (SAMPLES_UP * SAMPLES_ACROSS);
}

static void every_cell_is_drawn_once(void)
{
	static uint8_t seen[IMAGE_WARP_POINTS];

	memset(seen, 0, sizeof(seen));
	for (int i = 0; i < IMAGE_WARP_INDICES; i += 6)
		CHECK(seen[warp.index[i]]++ == 0); /* its lower left corner */
}

static void near_things_hide_far_ones_wherever_the_eye_goes(void **state)
{
	static const float moves[][3] = {
		{ 1, 0, 0 },     { -1, 0, 0 },       { 0, 1.5f, 0 }, { 0, -1.5f, 0 },
		{ 0, 0, 1 },     { 0, 0, -1 },       { 1, 1, 0.5f }, { -1, 2, 0 },
		{ 1, -2, 0.5f }, { -0.3f, 2, 0.2f }, { 2, 0, -1 },   { -2, -1, -1 },
	};
	(void)state;
	see(posts, 0);
	for (size_t i = 0; i < sizeof(moves) / sizeof(moves[0]); i++) {
		const struct view view = view_from(moves[i][0], moves[i][1], moves[i][2], 0);

		image_warp_place(&warp, &reference, &view);
		image_warp_order(&warp, &reference, &view);
		every_cell_is_drawn_once();
		CHECK(wrongly_hidden(&view) < 0.005f);
	}
}

static void it_reaches_as_far_as_little_is_missing(void **state)
{
	(void)state;
	see(posts, 0);
	struct view view = view_from(1, 0, 0, 0);
	CHECK(image_warp_off(&reference, &view) <= 1);
	view = view_from(9, 0, 0, 0);
	CHECK(image_warp_off(&reference, &view) > 1);
	view = reference.view;
	for (int k = 0; k < 3; k++)
		view.forward[k] = reference.view.right[k];
	CHECK(image_warp_off(&reference, &view) > 1);
}

/* Beside a wall that fills the picture, the eye that goes aside sees past its edge: by a tenth of
 * the view after a seventh of the distance. */
static void it_reaches_no_farther_than_its_edges(void **state)
{
	(void)state;
	see(a_wall, 0);
	const float wall_m = reference.nearest_m;
	struct view view = view_from(0.13f * wall_m, 0, 0, 0);
	CHECK(image_warp_off(&reference, &view) <= 1);
	view = view_from(0.17f * wall_m, 0, 0, 0);
	CHECK(image_warp_off(&reference, &view) > 1);
	view = view_from(-0.17f * wall_m, 0, 0, 0);
	CHECK(image_warp_off(&reference, &view) > 1);
	view = view_from(0, -0.2f * wall_m, 0, 0); /* back */
	CHECK(image_warp_off(&reference, &view) > 1);
	view = view_from(0, 0.5f * wall_m, 0, 0);
	CHECK(image_warp_off(&reference, &view) <= 1);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_same_eye_sees_the_same_picture),
		cmocka_unit_test(a_wall_moves_as_its_depth_says),
		cmocka_unit_test(nothing_is_far_away_and_only_turns),
		cmocka_unit_test(near_things_hide_far_ones_wherever_the_eye_goes),
		cmocka_unit_test(it_reaches_as_far_as_little_is_missing),
		cmocka_unit_test(it_reaches_no_farther_than_its_edges),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
