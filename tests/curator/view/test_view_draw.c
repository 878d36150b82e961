/* A view drawn from a little mesh, and the faces of it that a part of the view takes. */
#include "curator/view/view_draw.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/compiler.h"
#include "curator/select/face_pick.h"
#include "pipeline/samples/chunks.h"
#include "tests/check.h"

/* Two squares of 2 m, one behind the other at y = 0 and y = 3, of SIDE x SIDE quads; the eye looks
 * along y. */
enum { SIDE = 20, WIDTH = 160, HEIGHT = 90, SQUARES = 2 };

static const struct camera camera = { .eye_m = { 0, -4, 0 },
				      .target_m = { 0, 0, 0 },
				      .up = { 0, 0, 1 },
				      .fov_deg = 40,
				      .near_m = 0.1f,
				      .far_m = 100,
				      .width_px = WIDTH,
				      .height_px = HEIGHT };

static void make_mesh(struct mesh *mesh)
{
	const uint32_t vertices = (SIDE + 1) * (SIDE + 1);

	memset(mesh, 0, sizeof(*mesh));
	mesh->vertex_count = SQUARES * vertices;
	mesh->triangle_count = SQUARES * 2 * SIDE * SIDE;
	mesh->positions = calloc(mesh->vertex_count, sizeof(*mesh->positions));
	mesh->colours = calloc(mesh->vertex_count, sizeof(*mesh->colours));
	mesh->triangles = calloc(mesh->triangle_count, sizeof(*mesh->triangles));
	for (uint32_t v = 0; v < mesh->vertex_count; v++) {
		const uint32_t square = v / vertices, x = v % vertices % (SIDE + 1),
			       z = v % vertices / (SIDE + 1);

		mesh->positions[v][0] = 2.0f * (float)x / SIDE - 1;
		mesh->positions[v][1] = square ? 3 : 0;
		mesh->positions[v][2] = 2.0f * (float)z / SIDE - 1;
		memcpy(mesh->colours[v],
		       square ? (uint8_t[4]){ 10, 20, 200, 255 } : (uint8_t[4]){ 200, 20, 10, 255 },
		       4);
	}
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		const uint32_t quad = t / 2 % (SIDE * SIDE), square = t / (2 * SIDE * SIDE),
			       at = square * vertices + quad / SIDE * (SIDE + 1) + quad % SIDE;
		uint32_t *corners = mesh->triangles[t];

		corners[0] = at;
		corners[1] = t % 2 ? at + SIDE + 2 : at + 1;
		corners[2] = t % 2 ? at + SIDE + 1 : at + SIDE + 2;
	}
}

struct stage {
	struct mesh mesh;
	struct model *model;
	struct view_draw *draw;
	struct view_image image;
	struct face_blocks blocks;
};

static void raise_stage(struct stage *stage)
{
	make_mesh(&stage->mesh);
	CHECK(chunks_create(&stage->model, &stage->mesh, (const uint8_t[3]){ 0 }) == 0);
	CHECK(view_draw_create(&stage->draw, stage->model, WIDTH, HEIGHT) == 0);
	CHECK(view_draw_image(stage->draw, &camera, 0, &stage->image) == 0);
	CHECK(face_blocks_make(&stage->blocks, &stage->mesh) == 0);
}

static void strike_stage(struct stage *stage)
{
	face_blocks_finish(&stage->blocks);
	view_draw_destroy(stage->draw);
	model_destroy(stage->model);
	free(stage->mesh.positions);
	free(stage->mesh.colours);
	free(stage->mesh.triangles);
}

static void a_view_shows_the_model_where_the_camera_says(void **state)
{
	struct stage stage;

	(void)state;
	raise_stage(&stage);
	CHECK(stage.image.width_px == WIDTH && stage.image.height_px == HEIGHT);
	for (float x = -1.4f; x < 1.5f; x += 0.35f) {
		const float at[3] = { x, 0, 0.3f };
		float px[2];

		CHECK(camera_pixel(&camera, at, &px[0], &px[1]));
		const uint32_t pixel = (uint32_t)px[1] * WIDTH + (uint32_t)px[0];
		if (fabsf(x) > 1) {
			CHECK(stage.image.inverse_m[pixel] == 0);
			continue;
		}
		CHECK(fabsf(1 / stage.image.inverse_m[pixel] - 4) < 0.01f);
		CHECK(stage.image.colours[pixel][0] == 200 && stage.image.colours[pixel][2] == 10);
		CHECK(stage.image.normals[pixel][1] == -127); /* towards the eye */
	}
	strike_stage(&stage);
}

static void note(void *user, uint32_t triangle)
{
	uint32_t *counts = user;

	counts[triangle / (2 * SIDE * SIDE)]++;
}

static void a_part_takes_what_is_seen_or_all_behind_it(void **state)
{
	uint8_t left[WIDTH * HEIGHT];
	struct stage stage;
	uint32_t counts[SQUARES] = { 0 };

	(void)state;
	raise_stage(&stage);
	for (uint32_t at = 0; at < WIDTH * HEIGHT; at++)
		left[at] = at % WIDTH < WIDTH / 2;
	struct face_view view = { &camera, &stage.image, left, false };
	face_pick(&view, &stage.mesh, &stage.blocks, note, counts);
	CHECK(counts[0] == SIDE * SIDE && counts[1] == 0);
	view.through = true;
	memset(counts, 0, sizeof(counts));
	face_pick(&view, &stage.mesh, &stage.blocks, note, counts);
	CHECK(counts[0] == SIDE * SIDE && counts[1] == SIDE * SIDE);
	memset(left, 0, sizeof(left));
	memset(counts, 0, sizeof(counts));
	face_pick(&view, &stage.mesh, &stage.blocks, note, counts);
	CHECK(counts[0] == 0 && counts[1] == 0);
	strike_stage(&stage);
}

/* From behind, the squares turn away: they are not seen as faces, but lie in the depth. */
static void what_turns_away_is_not_seen(void **state)
{
	struct camera behind = camera;
	uint8_t all[WIDTH * HEIGHT];
	struct stage stage;
	uint32_t counts[SQUARES] = { 0 };

	(void)state;
	raise_stage(&stage);
	behind.eye_m[1] = 9;
	CHECK(view_draw_image(stage.draw, &behind, 0, &stage.image) == 0);
	memset(all, 1, sizeof(all));
	struct face_view view = { &behind, &stage.image, all, false };
	face_pick(&view, &stage.mesh, &stage.blocks, note, counts);
	CHECK(counts[0] == 0 && counts[1] == 0);
	view.through = true;
	face_pick(&view, &stage.mesh, &stage.blocks, note, counts);
	CHECK(counts[0] == 2 * SIDE * SIDE && counts[1] == 2 * SIDE * SIDE);
	strike_stage(&stage);
}

/* A triangle of the front square fills about five pixels. */
static void a_pixel_at_its_middle_does_not_decide_over_a_face(void **state)
{
	uint8_t pixels[WIDTH * HEIGHT];
	struct stage stage;
	uint32_t counts[SQUARES] = { 0 };
	float middle[3] = { 0 }, px[2];

	(void)state;
	raise_stage(&stage);
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 3; i++)
			middle[i] += stage.mesh.positions[stage.mesh.triangles[421][k]][i] / 3;
	CHECK(camera_pixel(&camera, middle, &px[0], &px[1]));
	const uint32_t pixel = (uint32_t)px[1] * WIDTH + (uint32_t)px[0];
	struct face_view view = { &camera, &stage.image, pixels, false };
	memset(pixels, 1, sizeof(pixels));
	pixels[pixel] = 0;
	face_pick(&view, &stage.mesh, &stage.blocks, note, counts);
	CHECK(counts[0] == 2 * SIDE * SIDE);
	memset(pixels, 0, sizeof(pixels));
	pixels[pixel] = 1;
	counts[0] = 0;
	face_pick(&view, &stage.mesh, &stage.blocks, note, counts);
	CHECK(counts[0] == 0);
	strike_stage(&stage);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_view_shows_the_model_where_the_camera_says),
		cmocka_unit_test(a_part_takes_what_is_seen_or_all_behind_it),
		cmocka_unit_test(what_turns_away_is_not_seen),
		cmocka_unit_test(a_pixel_at_its_middle_does_not_decide_over_a_face),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
