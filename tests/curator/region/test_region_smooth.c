/* Smoothing on a plane of 40 x 40 squares of two triangles each: what goes, and what stays. */
#include "tests/check.h"

#include <stdlib.h>

#include "curator/region/region_smooth.h"

enum { SIDE = 40, TRIANGLES = 2 * SIDE * SIDE };

struct plane {
	struct mesh mesh;
	float positions[(SIDE + 1) * (SIDE + 1)][3];
	uint32_t triangles[TRIANGLES][3];
};

/* The diagonals alternate, so that no direction is preferred. */
static struct plane *make_plane(void)
{
	struct plane *plane = calloc(1, sizeof(*plane));

	CHECK(plane);
	plane->mesh = (struct mesh){ .vertex_count = (SIDE + 1) * (SIDE + 1),
				     .triangle_count = TRIANGLES,
				     .positions = plane->positions,
				     .triangles = plane->triangles };
	for (uint32_t v = 0; v < plane->mesh.vertex_count; v++) {
		plane->positions[v][0] = (float)(v % (SIDE + 1));
		plane->positions[v][1] = (float)(v / (SIDE + 1));
	}
	for (uint32_t square = 0; square < SIDE * SIDE; square++) {
		const uint32_t x = square % SIDE, y = square / SIDE, a = y * (SIDE + 1) + x;
		const uint32_t corners[4] = { a, a + 1, a + SIDE + 2, a + SIDE + 1 };
		const uint32_t turn = (x + y) % 2;

		for (uint32_t half = 0; half < 2; half++)
			for (uint32_t k = 0; k < 3; k++)
				plane->triangles[2 * square + half][k] =
					corners[(turn + 2 * half + k) % 4];
	}
	return plane;
}

/* Whether a square has the region's two triangles; neither or both are expected. */
static bool has_square(const struct region_set *set, uint32_t x, uint32_t y)
{
	const uint32_t square = y * SIDE + x;

	return region_set_has(set, 2 * square) && region_set_has(set, 2 * square + 1);
}

static void put_square(struct region_set *set, uint32_t x, uint32_t y, bool in)
{
	region_set_put(set, 2 * (y * SIDE + x), in);
	region_set_put(set, 2 * (y * SIDE + x) + 1, in);
}

/* The left half. */
static void start(struct region_set *set)
{
	CHECK(region_set_init(set, TRIANGLES) == 0);
	region_set_begin(set);
	for (uint32_t y = 0; y < SIDE; y++)
		for (uint32_t x = 0; x < SIDE / 2; x++)
			put_square(set, x, y, true);
	CHECK(region_set_commit(set) == 0 && set->count == TRIANGLES / 2);
}

static void leaves_a_straight_border_where_it_is(void **state)
{
	struct plane *plane = make_plane();
	struct region_set set;

	(void)state;
	start(&set);
	CHECK(region_set_smooth(&set, &plane->mesh) == 0);
	CHECK(set.count == TRIANGLES / 2 && set.done_count == 1); /* no step */
	region_set_finish(&set);
	free(plane);
}

static void takes_teeth_notches_specks_and_holes_away(void **state)
{
	struct plane *plane = make_plane();
	struct region_set set;

	(void)state;
	start(&set);
	region_set_begin(&set);
	put_square(&set, SIDE / 2, 7, true);       /* a tooth */
	put_square(&set, SIDE / 2 - 1, 17, false); /* a notch */
	put_square(&set, 30, 20, true);            /* a speck */
	put_square(&set, 10, 20, false);           /* a hole */
	CHECK(region_set_commit(&set) == 0);
	CHECK(region_set_smooth(&set, &plane->mesh) == 0);
	CHECK(!has_square(&set, SIDE / 2, 7) && has_square(&set, SIDE / 2 - 1, 17));
	CHECK(!has_square(&set, 30, 20) && has_square(&set, 10, 20));
	CHECK(set.count == TRIANGLES / 2);
	/* All of it is one step. */
	CHECK(region_set_undo(&set) && has_square(&set, 30, 20) && !has_square(&set, 10, 20));
	CHECK(region_set_undo(&set) && set.count == TRIANGLES / 2);
	CHECK(region_set_redo(&set) && region_set_redo(&set) && !has_square(&set, 30, 20));
	region_set_finish(&set);
	free(plane);
}

/* Teeth of one square all along the border become straight, and none is left. */
static void straightens_a_border_of_teeth(void **state)
{
	struct plane *plane = make_plane();
	struct region_set set;
	uint32_t before = 0, after = 0;

	(void)state;
	start(&set);
	region_set_begin(&set);
	for (uint32_t y = 0; y < SIDE; y += 4)
		put_square(&set, SIDE / 2, y, true);
	CHECK(region_set_commit(&set) == 0);
	for (uint32_t y = 0; y < SIDE; y++)
		before += has_square(&set, SIDE / 2, y);
	CHECK(region_set_smooth(&set, &plane->mesh) == 0);
	for (uint32_t y = 1; y + 1 < SIDE; y++) {
		after += has_square(&set, SIDE / 2, y);
		CHECK(has_square(&set, SIDE / 2 - 1, y));
	}
	CHECK(before == SIDE / 4 && after == 0);
	region_set_finish(&set);
	free(plane);
}

/* A disc keeps its size within a fiftieth: smoothing does not shrink what is round. */
static void keeps_the_size_of_a_disc(void **state)
{
	struct plane *plane = make_plane();
	struct region_set set;
	uint32_t before;

	(void)state;
	CHECK(region_set_init(&set, TRIANGLES) == 0);
	region_set_begin(&set);
	for (uint32_t y = 0; y < SIDE; y++)
		for (uint32_t x = 0; x < SIDE; x++)
			if ((x - 20.0) * (x - 20.0) + (y - 20.0) * (y - 20.0) < 12 * 12)
				put_square(&set, x, y, true);
	CHECK(region_set_commit(&set) == 0);
	before = set.count;
	CHECK(region_set_smooth(&set, &plane->mesh) == 0);
	CHECK(set.count > before - before / 50 && set.count < before + before / 50);
	CHECK(has_square(&set, 20, 20));
	region_set_finish(&set);
	free(plane);
}

static void leaves_nothing_and_everything(void **state)
{
	struct plane *plane = make_plane();
	struct region_set set;

	(void)state;
	CHECK(region_set_init(&set, TRIANGLES) == 0);
	CHECK(region_set_smooth(&set, &plane->mesh) == 0 && set.count == 0);
	region_set_begin(&set);
	region_set_put_all(&set, true);
	CHECK(region_set_commit(&set) == 0);
	CHECK(region_set_smooth(&set, &plane->mesh) == 0 && set.count == TRIANGLES);
	CHECK(set.done_count == 1);
	region_set_finish(&set);
	free(plane);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(leaves_a_straight_border_where_it_is),
		cmocka_unit_test(takes_teeth_notches_specks_and_holes_away),
		cmocka_unit_test(straightens_a_border_of_teeth),
		cmocka_unit_test(keeps_the_size_of_a_disc),
		cmocka_unit_test(leaves_nothing_and_everything),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
