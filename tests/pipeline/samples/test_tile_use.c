#include "pipeline/samples/tile_use.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/vec.h"
#include "tests/check.h"

/* A wall of 2 x 2 m at y = 0, its front towards -y, and two sampling points 1.5 m before it. */
enum { POINTS = 2, LEVELS = 3, TILES = 1 + 4 + 16, WINDOWS = 64, SIDE = 9 };

static const struct lattice lattice = { { -10, -10, -10 }, 0.001, 0 };
static const struct hash key = { { 7 } };
static const float target[3] = { 0, 0, 1 };
static char dir[64];

static int make_dir(void **state)
{
	(void)state;
	snprintf(dir, sizeof(dir), "/tmp/gopura-use-XXXXXX");
	return mkdtemp(dir) ? 0 : -1;
}

static int remove_dir(void **state)
{
	char command[128];

	(void)state;
	snprintf(command, sizeof(command), "rm -rf %s", dir);
	return system(command);
}

/* ---- the surface */

static struct patch_mesh meshes[2];
static struct tile_use_patch patches[2];

/* An upright square at y_m around (x_m, 1); front: whether its front is towards -y. */
static void make_square(int n, float x_m, float y_m, float half_m, bool front)
{
	struct patch_mesh *mesh = &meshes[n];
	const float corner_m[3] = { x_m - half_m, y_m, 1 - half_m };

	memset(mesh, 0, sizeof(*mesh));
	mesh->vertices = calloc(SIDE * SIDE, sizeof(*mesh->vertices));
	mesh->indices = calloc(6 * SIDE * SIDE, sizeof(*mesh->indices));
	for (int i = 0; i < SIDE * SIDE; i++) {
		int32_t *at = mesh->vertices[mesh->vertex_count++].position;
		const float step_m = 2 * half_m / (SIDE - 1);

		at[0] = (int32_t)(1000 * (10 + corner_m[0] + step_m * (float)(i % SIDE)));
		at[1] = (int32_t)(1000 * (10 + corner_m[1]));
		at[2] = (int32_t)(1000 * (10 + corner_m[2] + step_m * (float)(i / SIDE)));
	}
	for (int i = 0; i < SIDE * (SIDE - 1); i++) {
		const int right = front ? i + 1 : i + SIDE, up = front ? i + SIDE : i + 1;
		const int corners[6] = { i, right, i + SIDE + 1, i, i + SIDE + 1, up };

		if (i % SIDE == SIDE - 1)
			continue;
		for (int k = 0; k < 6; k++)
			mesh->indices[3 * mesh->triangle_count + (uint32_t)k] =
				(uint16_t)corners[k];
		mesh->triangle_count += 2;
	}
	CHECK(patch_bvh_init(&patches[n].bvh, mesh, &lattice) == 0);
	memcpy(patches[n].centre_m, (float[3]){ x_m, y_m, 1 }, sizeof(patches[n].centre_m));
	patches[n].radius_m = 1.5f * half_m;
}

static void free_square(int n)
{
	patch_bvh_finish(&patches[n].bvh);
	free(meshes[n].vertices);
	free(meshes[n].indices);
}

/* ---- the samples */

static struct samples_store *fill(void)
{
	static const struct sample_grid grid = { .origin_m = { -0.8f, -1.5f, 1 },
						 .spacing_m = { 1.6f, 1, 1 },
						 .count = { POINTS, 1, 1 },
						 .level_count = LEVELS,
						 .choice_count = 2,
						 .qualities = { 20, 60 } };
	static const uint8_t bytes[2] = { 1, 2 };
	struct samples_store *store;
	float u, v;

	CHECK(samples_store_begin(dir, &grid, key) == 0);
	for (uint32_t x = 0; x < POINTS; x++) {
		uint16_t places[TILES], windows[TILES];
		uint32_t losses[TILES * SAMPLE_CHOICES_MAX] = { 0 };
		struct bytes objects[TILES * 2];
		struct sample_face face = { .face = cube_project((float[3]){ 0, 1, 0 }, &u, &v),
					    .level_count = LEVELS,
					    .coverage = 1,
					    .near_m = 1,
					    .far_m = 2,
					    .tile_count = TILES,
					    .tiles = places,
					    .objects = objects,
					    .windows = windows,
					    .losses = losses };

		for (uint16_t i = 0; i < TILES; i++) {
			places[i] = i;
			windows[i] = WINDOWS;
			objects[2 * i] = objects[2 * i + 1] = (struct bytes){ bytes, 2 };
		}
		CHECK(samples_store_put(dir, key, &grid, SAMPLE_RENDERED, (uint32_t[3]){ x, 0, 0 },
					&face, 1) == 0);
	}
	CHECK(samples_store_open(&store, dir) == 0);
	return store;
}

/* Sets out to the weights of all tiles, with a start view so far before the wall. */
static void weigh(float out[POINTS * TILES], uint32_t patch_count, float start_m)
{
	struct samples_store *store = fill();
	float *weights;

	CHECK(tile_use_make(&weights, store, patches, patch_count, (float[3]){ 0, -start_m, 1 },
			    target) == 0);
	memcpy(out, weights, POINTS * TILES * sizeof(*out));
	free(weights);
	samples_store_close(store);
}

/* ---- claims */

static bool is_near(float a, float b)
{
	return fabsf(a - b) < 1e-3f;
}

/* Both points see all of the wall, and views are as often left as right of the start. Texels are
 * mostly coarser than pixels, so it is the finest level that is shown. */
static void what_is_shown_weighs_more(void **state)
{
	float weights[POINTS * TILES], sum = 0;

	(void)state;
	make_square(0, 0, 0, 1, true);
	weigh(weights, 1, 4);
	for (uint32_t point = 0; point < POINTS; point++) {
		const float *of = &weights[point * TILES];

		CHECK(of[TILES - 1] > 1 && of[0] < 0.4f);
		for (uint32_t i = 0; i < TILES; i++) {
			CHECK(of[i] == of[i == 0 ? 0 : i < 5 ? 1 : 5]); /* a level is alike */
			sum += of[i];
		}
	}
	CHECK(weights[TILES - 1] < 1.3f * weights[2 * TILES - 1]);
	CHECK(weights[2 * TILES - 1] < 1.3f * weights[TILES - 1]);
	/* All pixels make one a pixel; and what is added for views not foreseen. */
	CHECK(is_near(sum / (POINTS * TILES), 1.3f));
	free_square(0);
}

static void from_afar_coarser_levels_are_shown(void **state)
{
	float near[POINTS * TILES], far[POINTS * TILES];

	(void)state;
	make_square(0, 0, 0, 1, true);
	weigh(near, 1, 4);
	weigh(far, 1, 60);
	CHECK(far[0] > 2 * near[0] && far[0] > far[TILES - 1]);
	CHECK(far[TILES - 1] < near[TILES - 1]);
	free_square(0);
}

/* A screen hides the wall from the first point, and little of it from visitors, who see its back
 * alone. */
static void a_point_that_sees_nothing_weighs_little(void **state)
{
	float weights[POINTS * TILES];

	(void)state;
	make_square(0, 0, 0, 1, true);
	make_square(1, -0.8f, -1.3f, 0.4f, false);
	weigh(weights, 2, 4);
	for (uint32_t i = 0; i < TILES; i++)
		CHECK(is_near(weights[i], 0.3f));
	CHECK(weights[2 * TILES - 1] > 2);
	free_square(0);
	free_square(1);
}

/* The back of the wall is not what the points see, so nothing is foreseen. */
static void without_anything_to_see_all_weigh_the_same(void **state)
{
	float weights[POINTS * TILES];

	(void)state;
	weigh(weights, 0, 4);
	for (uint32_t i = 0; i < POINTS * TILES; i++)
		CHECK(weights[i] == 1);
	make_square(0, 0, 0, 1, false);
	weigh(weights, 1, 0);
	for (uint32_t i = 0; i < POINTS * TILES; i++)
		CHECK(weights[i] == 1);
	free_square(0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_is_shown_weighs_more),
		cmocka_unit_test(from_afar_coarser_levels_are_shown),
		cmocka_unit_test(a_point_that_sees_nothing_weighs_little),
		cmocka_unit_test(without_anything_to_see_all_weigh_the_same),
	};

	return cmocka_run_group_tests(tests, make_dir, remove_dir);
}
