#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "pipeline/samples/chunks.h"
#include "tests/check.h"
#include "tests/pipeline/toy.h"

static const uint8_t grey[3] = { 100, 120, 140 };

static struct mesh big_sphere(void)
{
	struct mesh mesh = toy_empty(25000, 50000);

	toy_sphere(&mesh, (float[3]){ 1, 2, 3 }, 2, 100, grey);
	return mesh;
}

static double winding(struct model *model, const float point_m[3])
{
	uint32_t *pieces = malloc(model->piece_count * sizeof(*pieces));
	uint32_t count = model_choose(model, point_m, 0, pieces);
	double found;

	CHECK(count == model->piece_count);
	CHECK(model_winding(model, pieces, count, point_m, &found) == 0);
	free(pieces);
	return found;
}

static void keeps_every_triangle_once(void **state)
{
	struct mesh mesh = big_sphere();
	struct model *model;
	double area[3] = { 0 };
	uint64_t indices = 0;

	(void)state;
	CHECK(chunks_create(&model, &mesh, grey) == 0);
	CHECK(model->piece_count >= 9);
	for (uint32_t n = 0; n < model->piece_count; n++) {
		const struct model_piece *piece = &model->pieces[n];
		struct model_mesh part;

		CHECK(model_load(model, n, &part) == 0);
		CHECK(part.index_count / 3 <= CHUNK_TRIANGLES_MAX);
		indices += part.index_count;
		for (uint32_t i = 0; i < part.index_count; i++) {
			const float *p;

			CHECK(part.indices[i] < part.vertex_count);
			p = part.vertices[part.indices[i]].position_m;
			for (int c = 0; c < 3; c++)
				CHECK(p[c] >= piece->low_m[c] && p[c] <= piece->high_m[c]);
		}
		for (int c = 0; c < 3; c++)
			area[c] += piece->area_m2[c];
	}
	CHECK(indices == 3 * mesh.triangle_count);
	for (int c = 0; c < 3; c++)
		CHECK(fabs(area[c]) < 1e-4); /* it is closed */
	model_destroy(model);
	toy_free(&mesh);
}

static void points_normals_outward(void **state)
{
	struct mesh mesh = big_sphere();
	struct model *model;

	(void)state;
	CHECK(chunks_create(&model, &mesh, grey) == 0);
	for (uint32_t n = 0; n < model->piece_count; n++) {
		struct model_mesh part;

		CHECK(model_load(model, n, &part) == 0);
		for (uint32_t i = 0; i < part.vertex_count; i++) {
			const struct model_vertex *v = &part.vertices[i];

			for (int c = 0; c < 3; c++)
				CHECK(fabsf((float)v->normal[c] / 127 -
					    (v->position_m[c] - (float)(c + 1)) / 2) < 0.03f);
			CHECK(v->colour[0] == 100 && v->colour[3] == 255);
		}
	}
	model_destroy(model);
	toy_free(&mesh);
}

static void winds_once_around_the_inside(void **state)
{
	static const float inside[][3] = { { 1, 2, 3 }, { 1, 2, 4.9f }, { 2.5f, 2, 3.8f } };
	static const float outside[][3] = {
		{ 1, 2, 5.1f }, { 30, 0, 0 }, { -1.2f, 2, 3 }, { 9, 9, 9 }
	};
	struct mesh mesh = big_sphere();
	struct model *model;

	(void)state;
	CHECK(chunks_create(&model, &mesh, grey) == 0);
	for (size_t i = 0; i < ARRAY_COUNT(inside); i++)
		CHECK(fabs(winding(model, inside[i]) - 1) < 0.03);
	for (size_t i = 0; i < ARRAY_COUNT(outside); i++)
		CHECK(fabs(winding(model, outside[i])) < 0.03);
	model_destroy(model);
	toy_free(&mesh);
}

static void stays_meaningful_for_open_and_overlapping_scans(void **state)
{
	struct mesh mesh = toy_empty(600, 1200);
	struct model *model;

	(void)state;
	toy_sphere(&mesh, (float[3]){ 0, 0, 0 }, 1, 10, grey);
	toy_sphere(&mesh, (float[3]){ 1, 0, 0 }, 1, 10, grey);
	CHECK(chunks_create(&model, &mesh, grey) == 0);
	CHECK(winding(model, (float[3]){ 0.5f, 0, 0 }) > 1.9);
	CHECK(winding(model, (float[3]){ -0.5f, 0, 0 }) > 0.9);
	CHECK(fabs(winding(model, (float[3]){ 0.5f, 0.97f, 0 })) < 0.1);
	model_destroy(model);
	mesh.triangle_count = 380; /* of the first sphere a slice of a twentieth is gone */
	CHECK(chunks_create(&model, &mesh, grey) == 0);
	CHECK(winding(model, (float[3]){ 0, 0, 0 }) > 0.9);
	CHECK(fabs(winding(model, (float[3]){ 0, 0, 1.3f })) < 0.2);
	model_destroy(model);
	mesh.triangle_count = 0;
	CHECK(chunks_create(&model, &mesh, grey) == -EINVAL);
	toy_free(&mesh);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(keeps_every_triangle_once),
		cmocka_unit_test(points_normals_outward),
		cmocka_unit_test(winds_once_around_the_inside),
		cmocka_unit_test(stays_meaningful_for_open_and_overlapping_scans),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
