/* The rasteriser, against what can be worked out by hand. */
#include "pipeline/samples/raster.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/check.h"

enum { SIDE = 128 };

/* Looks along +y from the origin, 90 degrees: x and z of the plane y = 1 are -1..1 in the frame. */
static const struct camera camera = { .target_m = { 0, 1, 0 },
				      .up = { 0, 0, 1 },
				      .fov_deg = 90,
				      .near_m = 0.02f,
				      .width_px = SIDE,
				      .height_px = SIDE };

/* Two triangles between four corners that go anticlockwise, seen by the camera. */
static void draw_square(struct raster *raster, float corners[4][3])
{
	static const uint16_t indices[6] = { 0, 1, 2, 0, 2, 3 };
	struct model_vertex vertices[4] = { 0 };
	const struct model_mesh mesh = {
		.vertex_count = 4, .index_count = 6, .vertices = vertices, .indices = indices
	};

	for (int k = 0; k < 4; k++) {
		memcpy(vertices[k].position_m, corners[k], sizeof(corners[k]));
		vertices[k].normal[1] = -127;
		memcpy(vertices[k].colour, "\144\310\062\377", 4);
	}
	raster_draw(raster, &mesh);
}

static void draw_wall(struct raster *raster, float y, float low_x, float high_x)
{
	draw_square(raster, (float[4][3]){ { low_x, y, -y },
					   { high_x, y, -y },
					   { high_x, y, y },
					   { low_x, y, y } });
}

static struct raster *begin(void)
{
	struct raster *raster;

	CHECK(raster_create(&raster, SIDE, true) == 0);
	raster_begin(raster, &camera);
	return raster;
}

/* Returns the distance of a sample, 0: nothing. */
static float distance_at(const struct raster *raster, uint32_t x, uint32_t y)
{
	struct raster_block block;
	uint32_t at = y % 8 * 8 + x % 8;

	if (!raster_get_block(raster, x / 8, y / 8, &block) || block.inverse_m[at] == 0)
		return 0;
	CHECK((block.surface[at] & 0xffffff) == 0x800080); /* 0, -1, 0 */
	CHECK(block.surface[at] >> 24 == 255 || block.surface[at] >> 24 == 127);
	CHECK((block.colour[at] & 0xffffff) == 0x32c864);
	return 1 / block.inverse_m[at];
}

static bool is_back(const struct raster *raster, uint32_t x, uint32_t y)
{
	struct raster_block block;

	CHECK(raster_get_block(raster, x / 8, y / 8, &block));
	return block.surface[y % 8 * 8 + x % 8] >> 24 < 128;
}

static void covers_each_sample_of_a_square_and_no_other(void **state)
{
	struct raster *raster = begin();
	float near_m, far_m;

	(void)state;
	CHECK(!raster_range(raster, &near_m, &far_m));
	/* a quarter of the frame's width, half of its height, at the left and the bottom */
	draw_square(raster,
		    (float[4][3]){ { -2, 2, -2 }, { -1, 2, -2 }, { -1, 2, 0 }, { -2, 2, 0 } });
	for (uint32_t i = 0; i < SIDE * SIDE; i++) {
		uint32_t x = i % SIDE, y = i / SIDE;
		bool in = x < SIDE / 4 && y >= SIDE / 2;

		CHECK(fabsf(distance_at(raster, x, y) - (in ? 2 : 0)) < 1e-5f);
		if (in)
			CHECK(!is_back(raster, x, y));
	}
	CHECK(raster_range(raster, &near_m, &far_m));
	CHECK(near_m <= 2 && near_m > 1.999f && far_m >= 2 && far_m < 2.001f);
	raster_begin(raster, &camera);
	CHECK(!raster_range(raster, &near_m, &far_m));
	CHECK(distance_at(raster, 0, SIDE - 1) == 0);
	raster_destroy(raster);
}

static void shows_the_nearest_and_its_side(void **state)
{
	struct raster *raster = begin();

	(void)state;
	draw_wall(raster, 3, -3, 3);
	draw_wall(raster, 2, 2, 0); /* the right half, from behind */
	draw_wall(raster, 4, -4, 4);
	for (uint32_t x = 0; x < SIDE; x++) {
		CHECK(fabsf(distance_at(raster, x, 50) - (x < SIDE / 2 ? 3 : 2)) < 1e-5f);
		CHECK(is_back(raster, x, 50) == (x >= SIDE / 2));
	}
	raster_destroy(raster);
}

/* A floor one metre below, from behind the eye to the horizon. */
static void clips_what_passes_the_eye(void **state)
{
	const float far = 100000;
	struct raster *raster = begin();

	(void)state;
	draw_square(raster, (float[4][3]){ { -far, -far, -1 },
					   { far, -far, -1 },
					   { far, far, -1 },
					   { -far, far, -1 } });
	for (uint32_t i = 0; i < SIDE * SIDE; i++) {
		struct raster_block block;
		uint32_t x = i % SIDE, y = i / SIDE, at = y % 8 * 8 + x % 8;
		float down = ((float)y + 0.5f) / (SIDE / 2) - 1;

		if (down > 0) {
			CHECK(raster_get_block(raster, x / 8, y / 8, &block));
			CHECK(fabsf(block.inverse_m[at] - down) < 1e-3f);
		} else {
			CHECK(!raster_get_block(raster, x / 8, y / 8, &block) ||
			      block.inverse_m[at] == 0);
		}
	}
	raster_destroy(raster);
}

static void hides_only_what_is_behind(void **state)
{
	struct raster *raster = begin();

	(void)state;
	CHECK(!raster_hides(raster, (float[3]){ -1, 2, -1 }, (float[3]){ 1, 3, 1 }));
	draw_wall(raster, 2, -2, 0); /* the left half */
	CHECK(raster_hides(raster, (float[3]){ -2, 3, -1 }, (float[3]){ -0.5f, 4, 1 }));
	/* in front of it, through it, beside it, half beside it, around the eye */
	CHECK(!raster_hides(raster, (float[3]){ -1, 1, -0.5f }, (float[3]){ -0.5f, 1.5f, 0.5f }));
	CHECK(!raster_hides(raster, (float[3]){ -1, 1.5f, -0.5f }, (float[3]){ -0.5f, 3, 0.5f }));
	CHECK(!raster_hides(raster, (float[3]){ 0.5f, 3, -1 }, (float[3]){ 2, 4, 1 }));
	CHECK(!raster_hides(raster, (float[3]){ -1, 3, -1 }, (float[3]){ 1, 4, 1 }));
	CHECK(!raster_hides(raster, (float[3]){ -1, -1, -1 }, (float[3]){ 1, 4, 1 }));
	/* beside the frame */
	CHECK(raster_hides(raster, (float[3]){ 8, 3, -1 }, (float[3]){ 9, 4, 1 }));
	raster_destroy(raster);
}

enum { TRIANGLES = 2000, THREADS = 4 };

/* Triangles here and there, large and small, some of them behind the eye. */
static void scatter(struct model_vertex vertices[3 * TRIANGLES])
{
	uint32_t seed = 1;

	memset(vertices, 0, 3 * TRIANGLES * sizeof(*vertices));
	for (uint32_t i = 0; i < 3 * TRIANGLES; i++) {
		const float size = i / 3 % 10 ? 0.05f : 2;

		for (int k = 0; k < 3; k++) {
			seed = seed * 1664525 + 1013904223;
			vertices[i].position_m[k] =
				i % 3 ? vertices[i - 1].position_m[k] +
						size * ((float)(seed >> 8) / 8388608 - 1)
				      : 4 * ((float)(seed >> 8) / 8388608 - 1);
		}
		vertices[i].normal[i % 3] = 127;
		memcpy(vertices[i].colour, &seed, sizeof(vertices[i].colour));
	}
}

static void draws_the_same_with_several_threads(void **state)
{
	static struct model_vertex vertices[3 * TRIANGLES];
	static uint16_t indices[3 * TRIANGLES];
	const struct model_mesh meshes[2] = {
		{ .vertex_count = 3 * TRIANGLES,
		  .index_count = 3 * 1200,
		  .vertices = vertices,
		  .indices = indices },
		{ .vertex_count = 3 * TRIANGLES,
		  .index_count = 3 * (TRIANGLES - 1200),
		  .vertices = vertices,
		  .indices = indices + 3 * 1200 },
	};
	struct raster *whole = begin(), *shared = begin();
	uint32_t shown = 0;

	(void)state;
	scatter(vertices);
	for (uint32_t i = 0; i < 3 * TRIANGLES; i++)
		indices[i] = (uint16_t)i;
	raster_draw(whole, &meshes[0]);
	raster_draw(whole, &meshes[1]);
	CHECK(raster_draw_meshes(shared, meshes, 2, THREADS) == 0);
	for (uint32_t i = 0; i < SIDE / 8 * (SIDE / 8); i++) {
		struct raster_block a = { 0 }, b = { 0 };
		const bool shows = raster_get_block(whole, i % (SIDE / 8), i / (SIDE / 8), &a);

		CHECK(shows == raster_get_block(shared, i % (SIDE / 8), i / (SIDE / 8), &b));
		if (!shows)
			continue;
		shown++;
		CHECK(memcmp(a.inverse_m, b.inverse_m, RASTER_BLOCK_SAMPLES * sizeof(float)) == 0);
		for (uint32_t k = 0; k < RASTER_BLOCK_SAMPLES; k++)
			CHECK(a.inverse_m[k] <= 0 ||
			      (a.surface[k] == b.surface[k] && a.colour[k] == b.colour[k]));
	}
	CHECK(shown > 10);
	raster_destroy(whole);
	raster_destroy(shared);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(covers_each_sample_of_a_square_and_no_other),
		cmocka_unit_test(shows_the_nearest_and_its_side),
		cmocka_unit_test(clips_what_passes_the_eye),
		cmocka_unit_test(hides_only_what_is_behind),
		cmocka_unit_test(draws_the_same_with_several_threads),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
