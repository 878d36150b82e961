/* Pictures of frames, against the frames' samples averaged here. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/samples/chunks.h"
#include "pipeline/samples/shading.h"
#include "render/display/gl.h"
#include "render/display/headless.h"
#include "tests/check.h"
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
	CHECK(shading_create(&shading, frame, side, side, finer, options) == 0);
	camera.width_px = camera.height_px = side;
	camera_ray(&camera, (float)side / 2, (float)side / 2, forward);
	drawing_look(drawing, camera.eye_m, 0);
	CHECK(drawing_range(drawing, camera.eye_m, forward, &camera.near_m, &camera.far_m));
	camera_matrix(&camera, matrix);
	cube_frame_bind(frame);
	CHECK(drawing_draw(drawing, matrix, camera.eye_m, 1 / camera_px_per_radian(&camera)) == 0);
	if (samples) {
		*samples = malloc(bytes);
		glReadPixels(0, 0, side, side, GL_RGBA, GL_UNSIGNED_BYTE, *samples);
		CHECK(gl_check("reading a frame") == 0);
	}
	CHECK(cube_frame_range(frame, camera.near_m, camera.far_m, &found, &near_m, &far_m) == 0);
	CHECK(shading_take(shading, &camera, &rgba) == 0);
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

struct comparison {
	long shown, partial, coverage_differs, far_off; /* pixels; by more than 6 of 255 */
	double squares;                                 /* of all channels' differences */
};

static struct comparison compare(const uint8_t *picture, const uint8_t *samples, int side,
				 int finer)
{
	struct comparison all = { 0 };

	for (int i = 0; i < side / finer * (side / finer); i++) {
		int x = i % (side / finer), y = i / (side / finer), sum[3] = { 0 }, code = 0;
		int worst = 0;

		for (int k = 0; k < SHADING_SAMPLES; k++) { /* one counts as four */
			int row = finer * y + k / 2 % finer, column = finer * x + k % finer;
			const uint8_t *from =
				samples +
				4 * ((size_t)(side - 1 - row) * (size_t)side + (size_t)column);

			for (int c = 0; from[3] && c < 3; c++)
				sum[c] += from[c];
			code += from[3] ? SHADING_COVERED + (from[3] == DRAWING_BACK) : 0;
		}
		all.coverage_differs += picture[4 * i + 3] != code;
		all.shown += code > 0;
		all.partial += code > 0 && code < SHADING_COVERED * SHADING_SAMPLES;
		for (int c = 0; code == 0 && c < 3; c++)
			CHECK(picture[4 * i + c] == 0);
		for (int c = 0; code > 0 && c < 3; c++) {
			int off = abs(picture[4 * i + c] -
				      (int)lrintf((float)sum[c] / (float)(code / SHADING_COVERED)));

			worst = off > worst ? off : worst;
			all.squares += off * off;
		}
		all.far_off += worst > 6;
	}
	return all;
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
	const struct drawing_options material[] = {
		{ 0 },
		{ .procedural = true, .surfaces = true },
		{ .procedural = true, .surfaces = true, .lit = true, .sun = { 0, 0, 1 } },
	};
	const struct camera camera = { .eye_m = { 0.5f, 0, 0 },
				       .target_m = { 0.5f, 1, 0 },
				       .up = { 0, 0, 1 },
				       .fov_deg = 90 };
	struct mesh mesh = toy_empty(24, 12);

	(void)state;
	toy_box(&mesh, (float[3]){ -1, -1, -1 }, (float[3]){ 1, 1, 1 }, six);
	for (size_t i = 0; i < 2 * ARRAY_COUNT(material); i++) {
		int finer = 1 + (int)i % 2;
		uint8_t *picture;

		shoot(&mesh, &material[i / 2], camera, SIDE, finer, &picture, NULL);
		for (int k = 0; k < SIDE / finer * (SIDE / finer); k++)
			CHECK(picture[4 * k + 3] == SHADING_SAMPLES * (SHADING_COVERED + 1));
		free(picture);
	}
	toy_free(&mesh);
}

/* From where a pixel is a millimetre, a centimetre, a hand: with all detail, with some finer than a
 * pixel, with some gone. */
static void shades_stone_as_the_drawing_does(void **state)
{
	enum { SIDE = 512 };
	static const struct camera cameras[] = {
		{ .eye_m = { 2, -1.1f, 0.6f }, .target_m = { 0, 0, 0.2f }, .fov_deg = 50 },
		{ .eye_m = { 7, -5, 3 }, .target_m = { 0, 0, 0.2f }, .fov_deg = 40 },
		{ .eye_m = { 21, -12, 9 }, .target_m = { 0, 0, 0 }, .fov_deg = 24 },
	};
	const struct drawing_options drawn = { .procedural = true,
					       .lit = true,
					       .sun = { 0.48f, -0.6f, 0.64f } };
	struct drawing_options surfaces = drawn;
	struct mesh mesh = toy_empty(12000, 20000);

	(void)state;
	surfaces.surfaces = true;
	toy_sphere(&mesh, (float[3]){ 0.3f, -0.2f, 1 }, 1, 64, grey);
	toy_box(&mesh, (float[3]){ -3, -3, -0.5f }, (float[3]){ 3, 3, 0 }, six);
	toy_box(&mesh, (float[3]){ -1, -1, 0 }, (float[3]){ 0.4f, 1, 1.5f }, six);
	for (size_t i = 0; i < 2 * ARRAY_COUNT(cameras); i++) {
		struct camera camera = cameras[i / 2];
		int finer = 1 + (int)i % 2;
		uint8_t *picture, *samples;
		struct comparison all;
		double db;

		camera.up[2] = 1;
		shoot(&mesh, &drawn, camera, SIDE, finer, NULL, &samples);
		shoot(&mesh, &surfaces, camera, SIDE, finer, &picture, NULL);
		all = compare(picture, samples, SIDE, finer);
		db = 10 * log10(255.0 * 255 * 3 * (double)all.shown / all.squares);
		CHECK(all.coverage_differs == 0 && all.shown > 10000);
		if (db < 42 || all.far_off > all.shown / 30)
			fail_msg("camera %zu, %d: %.1f dB, %ld of %ld pixels are off", i / 2, finer,
				 db, all.far_off, all.shown);
		free(picture);
		free(samples);
	}
	toy_free(&mesh);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(averages_colours_of_a_large_frame),
		cmocka_unit_test(counts_backs),
		cmocka_unit_test(shades_stone_as_the_drawing_does),
	};

	return cmocka_run_group_tests(tests, start, stop);
}
