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

static void keeps_every_triangle_once(void **state)
{
	struct mesh mesh = big_sphere();
	struct chunks chunks;
	double area[3] = { 0 };

	(void)state;
	CHECK(chunks_init(&chunks, &mesh, grey) == 0);
	CHECK(chunks.count >= 9 && chunks.index_count == 3 * mesh.triangle_count);
	for (uint32_t n = 0; n < chunks.count; n++) {
		const struct chunk *chunk = &chunks.items[n];

		CHECK(chunk->index_count / 3 <= CHUNK_TRIANGLES_MAX);
		for (uint32_t i = 0; i < chunk->index_count; i++) {
			uint16_t index = chunks.indices[chunk->first_index + i];
			const float *p;

			CHECK(index < chunk->vertex_count);
			p = chunks.vertices[chunk->first_vertex + index].position_m;
			for (int c = 0; c < 3; c++)
				CHECK(p[c] >= chunk->low_m[c] && p[c] <= chunk->high_m[c]);
		}
		for (int c = 0; c < 3; c++)
			area[c] += chunk->area_m2[c];
	}
	for (int c = 0; c < 3; c++)
		CHECK(fabs(area[c]) < 1e-4); /* it is closed */
	chunks_finish(&chunks);
	toy_free(&mesh);
}

static void points_normals_outward(void **state)
{
	struct mesh mesh = big_sphere();
	struct chunks chunks;

	(void)state;
	CHECK(chunks_init(&chunks, &mesh, grey) == 0);
	for (uint32_t i = 0; i < chunks.vertex_count; i++) {
		const struct chunk_vertex *v = &chunks.vertices[i];

		for (int c = 0; c < 3; c++)
			CHECK(fabsf((float)v->normal[c] / 127 -
				    (v->position_m[c] - (float)(c + 1)) / 2) < 0.03f);
		CHECK(v->colour[0] == 100 && v->colour[3] == 255);
	}
	chunks_finish(&chunks);
	toy_free(&mesh);
}

static void winds_once_around_the_inside(void **state)
{
	static const float inside[][3] = { { 1, 2, 3 }, { 1, 2, 4.9f }, { 2.5f, 2, 3.8f } };
	static const float outside[][3] = {
		{ 1, 2, 5.1f }, { 30, 0, 0 }, { -1.2f, 2, 3 }, { 9, 9, 9 }
	};
	struct mesh mesh = big_sphere();
	struct chunks chunks;

	(void)state;
	CHECK(chunks_init(&chunks, &mesh, grey) == 0);
	for (size_t i = 0; i < ARRAY_COUNT(inside); i++)
		CHECK(fabs(chunks_winding(&chunks, inside[i]) - 1) < 0.03);
	for (size_t i = 0; i < ARRAY_COUNT(outside); i++)
		CHECK(fabs(chunks_winding(&chunks, outside[i])) < 0.03);
	chunks_finish(&chunks);
	toy_free(&mesh);
}

static void stays_meaningful_for_open_and_overlapping_scans(void **state)
{
	struct mesh mesh = toy_empty(600, 1200);
	struct chunks chunks;

	(void)state;
	toy_sphere(&mesh, (float[3]){ 0, 0, 0 }, 1, 10, grey);
	toy_sphere(&mesh, (float[3]){ 1, 0, 0 }, 1, 10, grey);
	CHECK(chunks_init(&chunks, &mesh, grey) == 0);
	CHECK(chunks_winding(&chunks, (float[3]){ 0.5f, 0, 0 }) > 1.9);
	CHECK(chunks_winding(&chunks, (float[3]){ -0.5f, 0, 0 }) > 0.9);
	CHECK(fabs(chunks_winding(&chunks, (float[3]){ 0.5f, 0.97f, 0 })) < 0.1);
	chunks_finish(&chunks);
	mesh.triangle_count = 380; /* of the first sphere a slice of a twentieth is gone */
	CHECK(chunks_init(&chunks, &mesh, grey) == 0);
	CHECK(chunks_winding(&chunks, (float[3]){ 0, 0, 0 }) > 0.9);
	CHECK(fabs(chunks_winding(&chunks, (float[3]){ 0, 0, 1.3f })) < 0.2);
	chunks_finish(&chunks);
	mesh.triangle_count = 0;
	CHECK(chunks_init(&chunks, &mesh, grey) == -EINVAL);
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
