/* Pictures of frames, against the frames' samples averaged here. */
#include <stdlib.h>
#include <string.h>

#include "geometry/camera.h"
#include "pipeline/samples/chunks.h"
#include "pipeline/samples/cube_frame.h"
#include "pipeline/samples/drawing.h"
#include "pipeline/samples/shading.h"
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

/* Draws into a frame of side pixels, `finer` samples a pixel's side. picture: as shading_take gives
 * it, or NULL. samples: the frame's colours, lowest row first, or NULL. Both owned by the caller.
 */
static void shoot(struct mesh *mesh, const struct drawing_options *options, struct camera camera,
		  int side, int finer, uint8_t **picture, uint8_t **samples)
{
	float matrix[16], forward[3], near_m, far_m;
	size_t bytes = (size_t)side * (size_t)side * 4;
	struct shading *shading;
	struct drawing *drawing;
	struct model *model;
	struct cube_frame *frame;
	const uint8_t *rgba;
	bool found;

	CHECK(chunks_create(&model, mesh, grey) == 0);
	CHECK(drawing_create(&drawing, model, mesh->textures, mesh->texture_count, options) == 0);
	CHECK(cube_frame_create(&frame, side, side) == 0);
	CHECK(shading_create(&shading, frame, side, side, finer) == 0);
	camera.width_px = camera.height_px = side;
	camera_ray(&camera, (float)side / 2, (float)side / 2, forward);
	sight_look(drawing_sight(drawing), camera.eye_m, 0);
	CHECK(sight_range(drawing_sight(drawing), camera.eye_m, forward, &camera.near_m,
			  &camera.far_m));
	camera_matrix(&camera, matrix);
	cube_frame_bind(frame);
	CHECK(drawing_draw(drawing, matrix, camera.eye_m, 1 / camera_px_per_radian(&camera)) == 0);
	if (samples) {
		*samples = malloc(bytes);
		glReadPixels(0, 0, side, side, GL_RGBA, GL_UNSIGNED_BYTE, *samples);
		CHECK(gl_check("reading a frame") == 0);
	}
	CHECK(cube_frame_range(frame, camera.near_m, camera.far_m, &found, &near_m, &far_m) == 0);
	CHECK(shading_take(shading, &rgba) == 0);
	if (picture) {
		bytes /= (size_t)(finer * finer);
		*picture = malloc(bytes);
		memcpy(*picture, rgba, bytes);
	}
	shading_destroy(shading);
	cube_frame_destroy(frame);
	drawing_destroy(drawing);
	model_destroy(model);
}

/* Large enough that 16 bits of float do not count its rows. */
static void averages_colours_of_a_large_frame(void **state)
{
	enum { SIDE = 2304 };
	const struct drawing_options plain = { 0 };
	const struct camera camera = { .eye_m = { 3, 1, 2 },
				       .target_m = { 0, 0.2f, 0.1f },
				       .up = { 0, 0, 1 },
				       .fov_deg = 60 };
	struct mesh mesh = toy_empty(24, 12);
	struct comparison all;
	uint8_t *picture, *samples;

	(void)state;
	toy_box(&mesh, (float[3]){ -1, -1, -1 }, (float[3]){ 1, 1, 1 }, six);
	for (int finer = 1; finer <= 2; finer++) {
		shoot(&mesh, &plain, camera, SIDE, finer, &picture, &samples);
		all = compare(picture, samples, SIDE, finer);
		CHECK(all.shown > SIDE * SIDE / 20 && all.coverage_differs == 0);
		CHECK(finer == 1 ? all.partial == 0 : all.partial > 500);
		CHECK(all.far_off == 0 && all.squares < 3.0 * (double)all.shown);
		free(picture);
		free(samples);
	}
	toy_free(&mesh);
}

static void counts_backs(void **state)
{
	enum { SIDE = 64 };
	const struct drawing_options plain = { 0 };
	const struct camera camera = { .eye_m = { 0.5f, 0, 0 },
				       .target_m = { 0.5f, 1, 0 },
				       .up = { 0, 0, 1 },
				       .fov_deg = 90 };
	struct mesh mesh = toy_empty(24, 12);

	(void)state;
	toy_box(&mesh, (float[3]){ -1, -1, -1 }, (float[3]){ 1, 1, 1 }, six);
	for (int finer = 1; finer <= 2; finer++) {
		uint8_t *picture;

		shoot(&mesh, &plain, camera, SIDE, finer, &picture, NULL);
		for (int k = 0; k < SIDE / finer * (SIDE / finer); k++)
			CHECK(picture[4 * k + 3] == SHADING_SAMPLES * (SHADING_COVERED + 1));
		free(picture);
	}
	toy_free(&mesh);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(averages_colours_of_a_large_frame),
		cmocka_unit_test(counts_backs),
	};

	return cmocka_run_group_tests(tests, start, stop);
}
