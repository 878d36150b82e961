/* Pictures of rasters, against the samples of GL frames averaged here. */
#include "pipeline/samples/resolve.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/samples/chunks.h"
#include "pipeline/samples/cube_frame.h"
#include "pipeline/samples/pieces.h"
#include "render/display/gl.h"
#include "render/display/headless.h"
#include "tests/check.h"
#include "tests/pipeline/samples/compare.h"
#include "tests/pipeline/toy.h"

static uint8_t six[6][3] = { { 250, 0, 0 },   { 0, 250, 0 },   { 0, 0, 250 },
			     { 250, 250, 0 }, { 0, 250, 250 }, { 250, 0, 250 } };
static const uint8_t grey[3] = { 100, 120, 140 };

static int start(void **state)
{
	return headless_create((struct headless **)state);
}

static int stop(void **state)
{
	headless_destroy(*state);
	return 0;
}

static void set_planes(struct camera *camera, struct sight *sight, int side)
{
	float forward[3];

	camera->width_px = camera->height_px = side;
	camera_forward(camera, forward);
	sight_look(sight, camera->eye_m, 0);
	CHECK(sight_range(sight, camera->eye_m, forward, &camera->near_m, &camera->far_m));
}

/* Lowest row first; owned by the caller. */
static uint8_t *draw_with_gl(struct mesh *mesh, const struct drawing_options *options,
			     struct camera camera, int side)
{
	uint8_t *samples = malloc((size_t)side * (size_t)side * 4);
	struct cube_frame *frame;
	struct drawing *drawing;
	struct model *model;
	float matrix[16];

	CHECK(chunks_create(&model, mesh, grey) == 0);
	CHECK(drawing_create(&drawing, model, NULL, 0, options) == 0);
	CHECK(cube_frame_create(&frame, side, side) == 0);
	set_planes(&camera, drawing_sight(drawing), side);
	camera_matrix(&camera, matrix);
	cube_frame_bind(frame);
	CHECK(drawing_draw(drawing, matrix, camera.eye_m, 1 / camera_px_per_radian(&camera)) == 0);
	glReadPixels(0, 0, side, side, GL_RGBA, GL_UNSIGNED_BYTE, samples);
	CHECK(gl_check("reading a frame") == 0);
	cube_frame_destroy(frame);
	drawing_destroy(drawing);
	model_destroy(model);
	return samples;
}

/* Owned by the caller. */
static uint8_t *draw_with_raster(struct mesh *mesh, const struct drawing_options *options,
				 struct camera camera, int side, int finer)
{
	uint8_t(*rgba)[4] = malloc((size_t)(side / finer) * (size_t)(side / finer) * 4);
	struct resolve *resolve;
	struct pieces *pieces;
	struct raster *raster;
	struct sight *sight;
	struct model *model;

	CHECK(chunks_create(&model, mesh, grey) == 0);
	CHECK(sight_create(&sight, model) == 0);
	CHECK(pieces_create(&pieces, model) == 0);
	CHECK(raster_create(&raster, (uint32_t)side, !options->procedural) == 0);
	CHECK(resolve_create(&resolve, raster, options, finer) == 0);
	set_planes(&camera, sight, side);
	raster_begin(raster, &camera);
	for (uint32_t n = 0; n < model->piece_count; n++) {
		struct model_mesh part;

		CHECK(pieces_get(pieces, n, &part) == 0);
		raster_draw(raster, &part);
	}
	resolve_take(resolve, &camera, rgba);
	resolve_destroy(resolve);
	raster_destroy(raster);
	pieces_destroy(pieces);
	sight_destroy(sight);
	model_destroy(model);
	return rgba[0];
}

static void counts_backs(void **state)
{
	enum { SIDE = 64 };
	const struct drawing_options options[] = {
		{ 0 },
		{ .procedural = true },
		{ .procedural = true, .lit = true, .sun = { 0, 0, 1 } },
	};
	const struct camera camera = { .eye_m = { 0.5f, 0, 0 },
				       .target_m = { 0.5f, 1, 0 },
				       .up = { 0, 0, 1 },
				       .fov_deg = 90 };
	struct mesh mesh = toy_empty(24, 12);

	(void)state;
	toy_box(&mesh, (float[3]){ -1, -1, -1 }, (float[3]){ 1, 1, 1 }, six);
	for (size_t i = 0; i < 2 * ARRAY_COUNT(options); i++) {
		int finer = 1 + (int)i % 2;
		uint8_t *picture = draw_with_raster(&mesh, &options[i / 2], camera, SIDE, finer);

		for (int k = 0; k < SIDE / finer * (SIDE / finer); k++)
			CHECK(picture[4 * k + 3] == SHADING_SAMPLES * (SHADING_COVERED + 1));
		free(picture);
	}
	toy_free(&mesh);
}

/* From where a pixel is a millimetre, a centimetre, a hand: with all detail, with some finer than a
 * pixel, with some gone. */
static void shows_what_gl_shows(void **state)
{
	enum { SIDE = 512 };
	static const struct camera cameras[] = {
		{ .eye_m = { 2, -1.1f, 0.6f }, .target_m = { 0, 0, 0.2f }, .fov_deg = 50 },
		{ .eye_m = { 7, -5, 3 }, .target_m = { 0, 0, 0.2f }, .fov_deg = 40 },
		{ .eye_m = { 21, -12, 9 }, .target_m = { 0, 0, 0 }, .fov_deg = 24 },
	};
	struct mesh mesh = toy_empty(12000, 20000);

	(void)state;
	toy_sphere(&mesh, (float[3]){ 0.3f, -0.2f, 1 }, 1, 64, grey);
	toy_box(&mesh, (float[3]){ -3, -3, -0.5f }, (float[3]){ 3, 3, 0 }, six);
	toy_box(&mesh, (float[3]){ -1, -1, 0 }, (float[3]){ 0.4f, 1, 1.5f }, six);
	for (size_t i = 0; i < 4 * ARRAY_COUNT(cameras); i++) {
		const struct drawing_options drawn = { .procedural = i % 4 < 2,
						       .lit = true,
						       .sun = { 0.48f, -0.6f, 0.64f } };
		struct camera camera = cameras[i / 4];
		int finer = 1 + (int)i % 2;
		uint8_t *picture, *samples;
		struct comparison all;
		double db;

		camera.up[2] = 1;
		samples = draw_with_gl(&mesh, &drawn, camera, SIDE);
		picture = draw_with_raster(&mesh, &drawn, camera, SIDE, finer);
		all = compare(picture, samples, SIDE, finer);
		db = 10 * log10(255.0 * 255 * 3 * (double)all.shown / all.squares);
		CHECK(all.coverage_differs <= all.shown / 2000 && all.shown > 10000);
		if (db < 42 || all.far_off > all.shown / 30)
			fail_msg("camera %zu, %d: %.1f dB, %ld of %ld pixels are off", i / 4, finer,
				 db, all.far_off, all.shown);
		free(picture);
		free(samples);
	}
	toy_free(&mesh);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(counts_backs),
		cmocka_unit_test(shows_what_gl_shows),
	};

	return cmocka_run_group_tests(tests, start, stop);
}
