/* The model on the GPU, against what can be worked out by hand. */
#include <math.h>
#include <stdlib.h>

#include "geometry/camera.h"
#include "geometry/light.h"
#include "pipeline/samples/chunks.h"
#include "pipeline/samples/cube_frame.h"
#include "pipeline/samples/drawing.h"
#include "render/display/gl.h"
#include "render/display/headless.h"
#include "tests/check.h"
#include "tests/pipeline/toy.h"

enum { SIDE = 128 };

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

struct shot {
	struct cube_frame *frame;
	uint8_t rgba[SIDE * SIDE * 4]; /* lowest row first */
	float near_m, far_m;
	bool found;
};

static void shoot(struct shot *shot, struct mesh *mesh, const struct drawing_options *options,
		  struct camera camera)
{
	struct model *model;
	struct drawing *drawing;
	float matrix[16], forward[3];

	CHECK(chunks_create(&model, mesh, grey) == 0);
	CHECK(drawing_create(&drawing, model, mesh->textures, mesh->texture_count, options) == 0);
	CHECK(cube_frame_create(&shot->frame, SIDE, SIDE) == 0);
	camera.width_px = camera.height_px = SIDE;
	for (int i = 0; i < 3; i++)
		forward[i] = camera.target_m[i] - camera.eye_m[i];
	sight_look(drawing_sight(drawing), camera.eye_m, 0);
	CHECK(sight_range(drawing_sight(drawing), camera.eye_m, forward, &camera.near_m,
			  &camera.far_m));
	camera_matrix(&camera, matrix);
	cube_frame_bind(shot->frame);
	CHECK(drawing_draw(drawing, matrix, camera.eye_m, 1 / camera_px_per_radian(&camera)) == 0);
	CHECK(cube_frame_range(shot->frame, camera.near_m, camera.far_m, &shot->found,
			       &shot->near_m, &shot->far_m) == 0);
	cube_frame_bind(shot->frame);
	glReadPixels(0, 0, SIDE, SIDE, GL_RGBA, GL_UNSIGNED_BYTE, shot->rgba);
	CHECK(gl_check("reading a frame") == 0);
	drawing_destroy(drawing);
	model_destroy(model);
}

static const uint8_t *pixel(const struct shot *shot, int x, int y_from_top)
{
	return shot->rgba + 4 * ((SIDE - 1 - y_from_top) * SIDE + x);
}

static struct mesh unit_box(void)
{
	struct mesh mesh = toy_empty(24, 12);

	toy_box(&mesh, (float[3]){ -1, -1, -1 }, (float[3]){ 1, 1, 1 }, six);
	return mesh;
}

/* From (3, 0, 0) with 90 degrees the side +x, two metres off, fills the middle half. */
static void draws_a_box_where_it_is(void **state)
{
	const struct drawing_options plain = { 0 };
	const struct camera camera = {
		.eye_m = { 3, 0, 0 }, .target_m = { 2, 0, 0 }, .up = { 0, 0, 1 }, .fov_deg = 90
	};
	struct mesh mesh = unit_box();
	struct shot shot;

	(void)state;
	shoot(&shot, &mesh, &plain, camera);
	for (int y = 0; y < SIDE; y++) {
		for (int x = 0; x < SIDE; x++) {
			const uint8_t *p = pixel(&shot, x, y);
			bool in = x >= 32 && x < 96 && y >= 32 && y < 96;

			CHECK(p[3] == (in ? 255 : 0));
			CHECK(p[0] == (in ? 250 : 0) && p[1] == 0 && p[2] == 0);
		}
	}
	CHECK(shot.found && shot.near_m <= 2 && shot.near_m > 1.997f);
	CHECK(shot.far_m >= 2 && shot.far_m < 2.003f);
	cube_frame_destroy(shot.frame);
	toy_free(&mesh);
}

static void marks_backs_seen_from_inside(void **state)
{
	const struct drawing_options plain = { 0 };
	const struct camera camera = { .eye_m = { 0.5f, 0, 0 },
				       .target_m = { 0.5f, 1, 0 },
				       .up = { 0, 0, 1 },
				       .fov_deg = 90 };
	struct mesh mesh = unit_box();
	struct shot shot;

	(void)state;
	shoot(&shot, &mesh, &plain, camera);
	for (int i = 0; i < SIDE * SIDE; i++)
		CHECK(shot.rgba[4 * i + 3] == DRAWING_BACK);
	CHECK(pixel(&shot, SIDE / 4, SIDE / 2)[2] == 250); /* +y */
	CHECK(pixel(&shot, SIDE - 1, SIDE / 2)[0] == 250); /* +x, half a metre to the right */
	cube_frame_destroy(shot.frame);
	toy_free(&mesh);
}

static void lights_a_sphere_by_its_normals(void **state)
{
	const struct drawing_options lit = { .lit = true, .sun = { 0.48f, -0.6f, 0.64f } };
	const struct camera camera = {
		.eye_m = { 0, -20, 0 }, .target_m = { 0, -19, 0 }, .up = { 0, 0, 1 }, .fov_deg = 6
	};
	struct mesh mesh = toy_empty(12000, 20000);
	struct shot shot;
	int inside = 0;

	(void)state;
	toy_sphere(&mesh, (float[3]){ 0, 0, 0 }, 1, 64, grey);
	shoot(&shot, &mesh, &lit, camera);
	for (int y = 0; y < SIDE; y += 3) {
		for (int x = 0; x < SIDE; x += 3) {
			float scale = 20 * tanf(3 * (float)M_PI / 180) / (SIDE / 2);
			float n[3] = { ((float)x + 0.5f - SIDE / 2) * scale, 0,
				       (SIDE / 2 - (float)y - 0.5f) * scale };
			float square = n[0] * n[0] + n[2] * n[2];
			const uint8_t *p = pixel(&shot, x, y);

			CHECK(p[3] == (square < 0.97f ? 255 : p[3]));
			CHECK(p[3] == (square > 1.03f ? 0 : p[3]));
			if (square > 0.6f)
				continue;
			/* Perspective shifts the place by up to a twentieth. */
			n[1] = -sqrtf(1 - square);
			inside++;
			for (int c = 0; c < 3; c++)
				CHECK(fabsf(p[c] - fminf(255, grey[c] * light_at(n, 1, lit.sun))) <
				      9);
		}
	}
	CHECK(inside > 300);
	CHECK(fabsf(shot.near_m - 19) < 0.05f && shot.far_m > 19.8f && shot.far_m < 20.05f);
	cube_frame_destroy(shot.frame);
	toy_free(&mesh);
}

static void draws_the_scans_pictures(void **state)
{
	const struct drawing_options plain = { 0 };
	const struct camera camera = { .eye_m = { 0, 0, 2 },
				       .target_m = { 0, 0, 1 },
				       .up = { 0, 1, 0 },
				       .fov_deg = 2 * 26.565f }; /* sees -1..1 at distance 2 */
	uint8_t left[] = { 200, 10, 10, 10, 200, 10, 10, 10, 200, 90, 90, 90 },
		right[] = { 50, 60, 70 };
	struct mesh_texture textures[] = { { 2, 2, left }, { 1, 1, right } };
	struct mesh mesh = toy_empty(8, 4);
	struct shot shot;

	(void)state;
	mesh.uvs = malloc(8 * sizeof(*mesh.uvs));
	mesh.materials = malloc(4 * sizeof(*mesh.materials));
	for (int half = 0; half < 2; half++) {
		for (int k = 0; k < 4; k++) {
			uint32_t n = toy_vertex(&mesh, (float)(half - 1 + (k == 1 || k == 2)),
						k >= 2 ? 1 : -1, 0, grey);

			mesh.uvs[n][0] = k == 1 || k == 2;
			mesh.uvs[n][1] = k >= 2;
		}
		for (uint32_t k = 1; k <= 2; k++) {
			mesh.materials[mesh.triangle_count] = (uint16_t)half;
			toy_triangle(&mesh, 4u * (uint32_t)half, 4u * (uint32_t)half + k,
				     4u * (uint32_t)half + k + 1);
		}
	}
	mesh.textures = textures;
	mesh.texture_count = 2;
	shoot(&shot, &mesh, &plain, camera);
	CHECK(abs(pixel(&shot, 16, 32)[0] - 200) < 12); /* texel (0, 0): top left */
	CHECK(abs(pixel(&shot, 48, 32)[1] - 200) < 12); /* top right */
	CHECK(abs(pixel(&shot, 16, 96)[2] - 200) < 12); /* bottom left */
	CHECK(abs(pixel(&shot, 100, 64)[0] - 50) < 2);  /* the other picture */
	CHECK(abs(pixel(&shot, 100, 64)[2] - 70) < 2);
	cube_frame_destroy(shot.frame);
	toy_free(&mesh);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(draws_a_box_where_it_is),
		cmocka_unit_test(marks_backs_seen_from_inside),
		cmocka_unit_test(lights_a_sphere_by_its_normals),
		cmocka_unit_test(draws_the_scans_pictures),
	};

	return cmocka_run_group_tests(tests, start, stop);
}
