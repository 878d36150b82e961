/* Where an eye may be, made from triangles: near stone, inside of stone, and through doors. */
#include "pipeline/release/solid_grid.h"

#include <errno.h>
#include <math.h>

#include "geometry/solid_space.h"
#include "geometry/vec.h"
#include "tests/check.h"

#define ROOM 0.15f

static const struct solid_grid_options around = {
	.box_min_m = { -3, -3, 0 },
	.box_max_m = { 3, 3, 3 },
	.cell_m = 0.1f,
	.room_m = ROOM,
};

/* Triangles, and how far a point is from the nearest of them along the axis where it is farthest.
 */
static struct {
	float corners[200][3][3];
	uint32_t count;
} model;

static void add_rectangle(const float from[3], const float u[3], const float v[3])
{
	for (int half = 0; half < 2; half++) {
		float(*c)[3] = model.corners[model.count++];

		vec_add(c[0], from, half ? v : (const float[]){ 0, 0, 0 });
		vec_add(c[1], from, u);
		vec_add(c[2], from, v);
		if (half)
			vec_add(c[2], c[2], u);
	}
}

/* The six faces of a block of stone. */
static void add_block(const float low[3], const float high[3])
{
	for (int axis = 0; axis < 3; axis++) {
		const int b = (axis + 1) % 3, c = (axis + 2) % 3;
		float u[3] = { 0 }, v[3] = { 0 }, from[3];

		u[b] = high[b] - low[b];
		v[c] = high[c] - low[c];
		vec_copy(from, low);
		add_rectangle(from, u, v);
		from[axis] = high[axis];
		add_rectangle(from, u, v);
	}
}

/* A chamber of blocks with faces alone, 2.4 m wide within; in the south a door or a wall. */
static void add_chamber(float door_m)
{
	model.count = 0;
	add_block((float[]){ -2, -2, 0 }, (float[]){ -1.2f, 2, 3 });
	add_block((float[]){ 1.2f, -2, 0 }, (float[]){ 2, 2, 3 });
	add_block((float[]){ -2, 1.2f, 0 }, (float[]){ 2, 2, 3 });
	add_block((float[]){ -2, -2, 2.4f }, (float[]){ 2, 2, 3 });
	add_block((float[]){ -2, -2, 0 }, (float[]){ -door_m / 2, -1.2f, 3 });
	add_block((float[]){ door_m / 2, -2, 0 }, (float[]){ 2, -1.2f, 3 });
	add_rectangle((float[]){ -3, -3, 0 }, (float[]){ 6, 0, 0 }, (float[]){ 0, 6, 0 });
}

static void make(struct solid *out, const float *eye_m)
{
	struct solid_grid *grid;
	struct buffer object;

	CHECK(solid_grid_create(&grid, &around) == 0);
	for (uint32_t i = 0; i < model.count; i++)
		solid_grid_add(grid, (const float(*)[3])model.corners[i]);
	if (eye_m)
		solid_grid_open(grid, eye_m);
	CHECK(solid_grid_tree(grid, out) == 0);
	solid_grid_destroy(grid);
	buffer_init(&object, 1 << 20);
	CHECK(solid_encode(&object, out) == 0);
	buffer_finish(&object);
}

/* The distance of a point from the stone of the chamber, along the axis where it is farthest; below
 * 0 within. Doors are a metre wide. */
static float away_m(const float p[3])
{
	const float x = fabsf(p[0]), y = fabsf(p[1]);
	const float outside = fmaxf(fmaxf(x - 2, y - 2), p[2] - 3);
	const float inside = fminf(fminf(1.2f - x, 1.2f - y), 2.4f - p[2]);
	const float door = fminf(fminf(0.5f - x, -p[1]), 2.4f - p[2]);

	return fminf(p[2], fmaxf(outside, fmaxf(inside, door)));
}

static const float within[3] = { 0.3f, 0.2f, 1.2f }, in_wall[3] = { -1.6f, 0, 1.5f };

static void an_eye_keeps_off_and_comes_near(void **state)
{
	struct solid solid;

	(void)state;
	add_chamber(1);
	make(&solid, NULL);
	CHECK(solid.cell_m == 0.1f && solid.room_m == ROOM);
	for (int i = 0; i < 61 * 61 * 33; i++) {
		const float p[3] = { (float)(i % 61) * 0.1f - 3, (float)(i / 61 % 61) * 0.1f - 3,
				     (float)(i / 61 / 61) * 0.1f };
		const float away = away_m(p);

		if (away < ROOM - 1e-3f)
			CHECK(!solid_is_free(&solid, p));
		if (away > ROOM + 0.21f)
			CHECK(solid_is_free(&solid, p));
	}
	CHECK(solid_is_free(&solid, within) && !solid_is_free(&solid, in_wall));
	solid_finish(&solid);
}

static void a_room_without_a_door_is_stone(void **state)
{
	struct solid solid;

	(void)state;
	add_chamber(0);
	make(&solid, NULL);
	CHECK(!solid_is_free(&solid, within) && !solid_is_free(&solid, in_wall));
	CHECK(solid_is_free(&solid, (float[]){ 0, 0, 3.5f }));
	solid_finish(&solid);
	add_chamber(0.3f); /* a slit, narrower than twice the room */
	make(&solid, NULL);
	CHECK(!solid_is_free(&solid, within));
	solid_finish(&solid);
}

static void a_room_where_an_eye_is_known_to_be_is_free(void **state)
{
	const float beside[3] = { 1.15f, 0.5f, 1 };
	struct solid solid;

	(void)state;
	add_chamber(0);
	make(&solid, within);
	CHECK(solid_is_free(&solid, within) && !solid_is_free(&solid, in_wall));
	solid_finish(&solid);
	make(&solid, beside); /* too near to the wall: its nearest free cell counts */
	CHECK(solid_is_free(&solid, within) && !solid_is_free(&solid, beside));
	solid_finish(&solid);
	make(&solid, in_wall);
	CHECK(!solid_is_free(&solid, within));
	solid_finish(&solid);
}

static void refuses_a_grid_too_large(void **state)
{
	struct solid_grid_options options = around;
	struct solid_grid *grid;

	(void)state;
	options.cell_m = 0.002f;
	CHECK(solid_grid_create(&grid, &options) == -EFBIG && !grid);
	options.cell_m = 1e-6f;
	CHECK(solid_grid_create(&grid, &options) == -EFBIG && !grid);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(an_eye_keeps_off_and_comes_near),
		cmocka_unit_test(a_room_without_a_door_is_stone),
		cmocka_unit_test(a_room_where_an_eye_is_known_to_be_is_free),
		cmocka_unit_test(refuses_a_grid_too_large),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
