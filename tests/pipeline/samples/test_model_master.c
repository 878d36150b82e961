/* The master as a model: what is chosen covers the surface once, is coarser where it is far, and
 * looks like the finest. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "geometry/camera.h"
#include "pipeline/samples/cube_frame.h"
#include "pipeline/samples/drawing.h"
#include "pipeline/samples/model_master.h"
#include "pipeline/samples/raster.h"
#include "render/display/gl.h"
#include "render/display/headless.h"
#include "tests/check.h"
#include "tests/pipeline/shapes.h"

enum { SIDE = 256 };

struct home {
	char folder[64], master_folder[96];
	struct master *master;
	struct model *model;
};

static int home_start(void **state)
{
	static const struct hash stamp = { { 7 } };
	static const struct master_options options = {
		.multires = { .patch_triangles = 64, .top_triangles = 400, .jobs = 2 },
	};
	struct home *home = calloc(1, sizeof(*home));
	struct mesh mesh = shape_relief(150);
	struct master_report report;

	memcpy(home->folder, "/tmp/gopura-model-XXXXXX", 25);
	CHECK(mkdtemp(home->folder) != NULL);
	snprintf(home->master_folder, sizeof(home->master_folder), "%s/master", home->folder);
	CHECK(master_build(home->master_folder, &mesh, stamp, &options, &report) == 0);
	CHECK(master_open(&home->master, home->master_folder, &stamp) == 0);
	CHECK(model_of_master(&home->model, home->master) == 0);
	mesh_finish(&mesh);
	*state = home;
	return 0;
}

static int home_stop(void **state)
{
	struct home *home = *state;
	char command[160];

	model_destroy(home->model);
	master_destroy(home->master);
	snprintf(command, sizeof(command), "rm -r %s", home->folder);
	CHECK(system(command) == 0);
	free(home);
	return 0;
}

static void eye_at(const struct home *home, float sizes, float out[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = (home->model->low_m[i] + home->model->high_m[i]) / 2;
	out[2] += sizes * (home->model->high_m[0] - home->model->low_m[0]);
}

/* Sums triangles, area as a vector, and checks that each vertex lies in its piece's box. */
static uint64_t survey(struct model *model, const uint32_t *pieces, uint32_t count, double area[3])
{
	uint64_t triangles = 0;

	memset(area, 0, 3 * sizeof(*area));
	for (uint32_t n = 0; n < count; n++) {
		const struct model_piece *piece = &model->pieces[pieces[n]];
		struct model_mesh mesh;

		CHECK(model_load(model, pieces[n], &mesh) == 0);
		triangles += mesh.index_count / 3;
		for (uint32_t i = 0; i < mesh.vertex_count; i++)
			for (int c = 0; c < 3; c++) {
				float at = mesh.vertices[i].position_m[c];

				CHECK(at >= piece->low_m[c] - 1e-4f &&
				      at <= piece->high_m[c] + 1e-4f);
			}
		for (int c = 0; c < 3; c++)
			area[c] += piece->area_m2[c];
	}
	return triangles;
}

static void chooses_all_of_the_surface_and_fewer_triangles_from_afar(void **state)
{
	struct home *home = *state;
	uint32_t *pieces = malloc(home->model->piece_count * sizeof(*pieces));
	uint64_t finest = 0, before = UINT64_MAX;
	double whole[3], area[3];

	for (uint32_t p = 0; p < home->master->hierarchy.patch_count; p++)
		if (home->master->hierarchy.patches[p].finer == HIERARCHY_NONE)
			finest += home->master->hierarchy.patches[p].triangle_count;
	for (int step = 0; step < 5; step++) {
		float eye[3], sizes = powf(4, (float)step);
		uint32_t count;
		uint64_t triangles;

		eye_at(home, sizes, eye);
		count = model_choose(home->model, eye, 0, pieces);
		CHECK(survey(home->model, pieces, count, whole) == finest);
		count = model_choose(home->model, eye, 2.0f / 1000, pieces);
		triangles = survey(home->model, pieces, count, area);
		CHECK(triangles <= before);
		before = triangles;
		/* the area as a vector depends on the border alone, of which coarser cuts leave out
		 * corners */
		for (int c = 0; c < 3; c++)
			CHECK(fabs(area[c] - whole[c]) <= 0.02 * fabs(whole[2]));
	}
	CHECK(before < finest / 4);
	free(pieces);
}

static void shoot(struct drawing *drawing, struct cube_frame *frame, const float eye[3],
		  const float target[3], uint8_t *rgba)
{
	struct camera camera = {
		.up = { 0, 1, 0 }, .fov_deg = 90, .width_px = SIDE, .height_px = SIDE
	};
	float matrix[16], forward[3] = { 0, 0, -1 };

	memcpy(camera.eye_m, eye, sizeof(camera.eye_m));
	memcpy(camera.target_m, target, sizeof(camera.target_m));
	CHECK(sight_range(drawing_sight(drawing), eye, forward, &camera.near_m, &camera.far_m));
	camera_matrix(&camera, matrix);
	cube_frame_bind(frame);
	CHECK(drawing_draw(drawing, matrix, eye, 1 / camera_px_per_radian(&camera)) == 0);
	cube_frame_bind(frame);
	glReadPixels(0, 0, SIDE, SIDE, GL_RGBA, GL_UNSIGNED_BYTE, rgba);
}

/* Mean over 2 x 2 samples, as faces are made. */
static double psnr(const uint8_t *a, const uint8_t *b)
{
	double sum = 0;

	for (int y = 0; y < SIDE; y += 2)
		for (int x = 0; x < SIDE; x += 2)
			for (int c = 0; c < 3; c++) {
				int difference = 0;

				for (int k = 0; k < 4; k++) {
					int at = 4 * ((y + k / 2) * SIDE + x + k % 2) + c;

					difference += a[at] - b[at];
				}
				sum += difference * difference / 16.0;
			}
	return 10 * log10(255.0 * 255 / (sum / (SIDE / 2 * SIDE / 2 * 3) + 1e-9));
}

static void looks_like_the_finest(void **state)
{
	struct home *home = *state;
	const struct drawing_options options = { .lit = true, .sun = { 0.48f, -0.6f, 0.64f } };
	uint8_t *fine = malloc(SIDE * SIDE * 4), *coarse = malloc(SIDE * SIDE * 4);
	struct headless *headless;
	struct drawing *drawing;
	struct cube_frame *frame;

	CHECK(headless_create(&headless) == 0);
	CHECK(drawing_create(&drawing, home->model, NULL, 0, &options) == 0);
	CHECK(cube_frame_create(&frame, SIDE, SIDE) == 0);
	for (int step = 0; step < 3; step++) {
		float eye[3], target[3];
		uint32_t all, chosen;

		eye_at(home, powf(2, (float)step + 1), eye);
		memcpy(target, eye, sizeof(target));
		target[2] -= 1;
		sight_look(drawing_sight(drawing), eye, 0);
		sight_pieces(drawing_sight(drawing), &all);
		shoot(drawing, frame, eye, target, fine);
		sight_look(drawing_sight(drawing), eye,
			   2.0f / (SIDE / 2)); /* a texel is two samples */
		sight_pieces(drawing_sight(drawing), &chosen);
		CHECK(chosen < all);
		shoot(drawing, frame, eye, target, coarse);
		printf("%.1f sizes away: %u of %u pieces, %.1f dB\n", powf(2, (float)step + 1),
		       chosen, all, psnr(fine, coarse));
		CHECK(psnr(fine, coarse) > 50);
		CHECK(memcmp(fine, coarse, SIDE * SIDE * 4) != 0);
	}
	cube_frame_destroy(frame);
	drawing_destroy(drawing);
	headless_destroy(headless);
	free(fine);
	free(coarse);
}

/* Looks down at the relief past a wall, which hides the left half. */
static void start_raster(const struct home *home, struct raster *raster, struct camera *camera)
{
	static const uint16_t indices[6] = { 0, 1, 2, 0, 2, 3 };
	struct model_vertex vertices[4] = { 0 };
	const struct model_mesh wall = {
		.vertex_count = 4, .index_count = 6, .vertices = vertices, .indices = indices
	};
	float side = home->model->high_m[0] - home->model->low_m[0];

	*camera = (struct camera){ .up = { 0, 0, 1 },
				   .fov_deg = 60,
				   .near_m = 0.001f * side,
				   .width_px = SIDE,
				   .height_px = SIDE };
	for (int i = 0; i < 3; i++)
		camera->target_m[i] = (home->model->low_m[i] + home->model->high_m[i]) / 2;
	memcpy(camera->eye_m, camera->target_m, sizeof(camera->eye_m));
	camera->up[1] = 1;
	camera->up[2] = 0;
	camera->eye_m[2] += 1.2f * side;
	raster_begin(raster, camera);
	for (int k = 0; k < 4; k++) {
		vertices[k].position_m[0] = camera->eye_m[0] - (k == 1 || k == 2 ? 0 : side);
		vertices[k].position_m[1] = camera->eye_m[1] + (k < 2 ? -side : side);
		vertices[k].position_m[2] = camera->eye_m[2] - 0.5f * side;
	}
	raster_draw(raster, &wall);
}

static void draw_piece(const struct home *home, struct raster *raster, uint32_t piece)
{
	struct model_mesh mesh;

	CHECK(model_load(home->model, piece, &mesh) == 0);
	raster_draw(raster, &mesh);
}

static void is_the_same_without_what_is_hidden(void **state)
{
	struct home *home = *state;
	struct raster *all, *some;
	struct camera camera;
	struct sight *sight;
	const uint32_t *pieces;
	uint32_t count, hidden = 0;
	float matrix[16];

	CHECK(sight_create(&sight, home->model) == 0);
	CHECK(raster_create(&all, SIDE, false) == 0);
	CHECK(raster_create(&some, SIDE, false) == 0);
	start_raster(home, all, &camera);
	start_raster(home, some, &camera);
	camera.far_m = 1000;
	camera_matrix(&camera, matrix);
	sight_look(sight, camera.eye_m, 0);
	pieces = sight_visible(sight, matrix, camera.eye_m, &count);
	for (uint32_t n = 0; n < count; n++) {
		const struct model_piece *piece = &home->model->pieces[pieces[n]];

		draw_piece(home, all, pieces[n]);
		if (raster_hides(some, piece->low_m, piece->high_m))
			hidden++;
		else
			draw_piece(home, some, pieces[n]);
	}
	printf("%u of %u pieces are hidden\n", hidden, count);
	CHECK(hidden > count / 4 && hidden < count * 3 / 4);
	for (uint32_t i = 0; i < SIDE / 8 * SIDE / 8; i++) {
		uint32_t column = i % (SIDE / 8), row = i / (SIDE / 8);
		struct raster_block a, b;
		bool shows = raster_get_block(all, column, row, &a);

		CHECK(raster_get_block(some, column, row, &b) == shows);
		for (int k = 0; shows && k < RASTER_BLOCK_SAMPLES; k++) {
			CHECK(a.inverse_m[k] == b.inverse_m[k]);
			CHECK(a.inverse_m[k] == 0 || a.surface[k] == b.surface[k]);
		}
	}
	raster_destroy(some);
	raster_destroy(all);
	sight_destroy(sight);
}

static void says_so_where_the_master_is_damaged(void **state)
{
	struct home *home = *state;
	char path[256], hex[HASH_HEX_BYTES];
	struct model_mesh mesh;
	struct model *model;

	hash_to_hex(home->master->stamp, hex);
	snprintf(path, sizeof(path), "%s/groups-%s", home->master_folder, hex);
	CHECK(truncate(path, 100) == 0);
	CHECK(model_of_master(&model, home->master) == 0);
	CHECK(model_load(model, model->piece_count - 1, &mesh) == -EBADMSG);
	model_destroy(model);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(chooses_all_of_the_surface_and_fewer_triangles_from_afar),
		cmocka_unit_test(looks_like_the_finest),
		cmocka_unit_test(is_the_same_without_what_is_hidden),
		cmocka_unit_test(says_so_where_the_master_is_damaged),
	};

	return cmocka_run_group_tests(tests, home_start, home_stop);
}
