/* A model within a number of bytes, read back by the importer. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "pipeline/import/import.h"
#include "pipeline/texmesh/reduced_mesh.h"
#include "pipeline/texmesh/texmesh.h"
#include "pipeline/texmesh/vertex_scales.h"
#include "tests/check.h"
#include "tests/pipeline/shapes.h"

enum { ROUND = 160, HIGH = 120, SIDE_PX = 512 };

/* Gentle noise, the same on every machine. */
static float noise(uint32_t x, uint32_t y)
{
	uint32_t n = x * 73856093u ^ y * 19349663u;

	n = (n ^ (n >> 13)) * 1274126177u;
	return (float)(n >> 8 & 0xffff) / 65535;
}

/* A pillar 4 m high with a relief on its upper half, in one picture that is wrapped round it: the
 * seam's vertices are there twice. Without caps. */
static struct mesh make_pillar(void)
{
	struct mesh mesh;

	shape_room(&mesh, (ROUND + 1) * (HIGH + 1), 2 * ROUND * HIGH);
	mesh.uvs = calloc((ROUND + 1) * (HIGH + 1), sizeof(*mesh.uvs));
	mesh.materials = calloc(2 * ROUND * HIGH, sizeof(*mesh.materials));
	mesh.textures = calloc(1, sizeof(*mesh.textures));
	mesh.texture_count = 1;
	mesh.textures[0] = (struct mesh_texture){ SIDE_PX, SIDE_PX, malloc(3 * SIDE_PX * SIDE_PX) };
	for (uint32_t i = 0; i < SIDE_PX * SIDE_PX; i++) {
		const float fine = noise(i % SIDE_PX / 3, i / SIDE_PX / 3);

		for (int k = 0; k < 3; k++)
			mesh.textures[0].rgb[3 * i + k] = (uint8_t)(90 + 20 * k + 60 * fine);
	}
	for (uint32_t y = 0; y <= HIGH; y++)
		for (uint32_t x = 0; x <= ROUND; x++) {
			const float turn = 6.2831853f * (float)(x % ROUND) / ROUND;
			const float up = (float)y / HIGH;
			const float relief = sinf(12 * turn) * sinf(40 * up) > 0 ? 0.05f : 0;
			const float r = 1 + (up > 0.5f ? relief : 0);
			const uint32_t v =
				shape_vertex(&mesh, r * cosf(turn), r * sinf(turn), 4 * up);

			mesh.uvs[v][0] = (float)x / ROUND;
			mesh.uvs[v][1] = up;
		}
	for (uint32_t y = 0; y < HIGH; y++)
		for (uint32_t x = 0; x < ROUND; x++) {
			const uint32_t a = y * (ROUND + 1) + x, b = a + ROUND + 1;

			shape_triangle(&mesh, a, a + 1, b);
			shape_triangle(&mesh, b, a + 1, b + 1);
		}
	return mesh;
}

static int make(struct buffer *file, const struct mesh *mesh, uint64_t budget_bytes, bool uniform,
		struct texmesh_report *report)
{
	const struct texmesh_options options = { .budget_bytes = budget_bytes, .uniform = uniform };

	buffer_init(file, TEXMESH_BUDGET_MOST_BYTES);
	return texmesh_make(file, mesh, &options, report);
}

/* Imports what was made, from a file. */
static void read_back(struct mesh *out, const struct buffer *file, struct import_report *report)
{
	const struct import_options options = { .up = IMPORT_Y_UP };
	struct diagnostics diagnostics = { 0 };
	char path[] = "/tmp/gopura-texmesh-XXXXXX.glb";
	const int fd = mkstemps(path, 4);

	CHECK(fd >= 0);
	CHECK(bytes_write_to(fd, buffer_bytes(file)) == 0);
	close(fd);
	if (import_scan(out, path, &options, report, &diagnostics) < 0)
		fail_msg("%s", diagnostics_cause(&diagnostics, -EIO));
	unlink(path);
}

static void a_model_takes_its_budget(void **state)
{
	static const uint64_t budgets[] = { 30000, 60000, 120000, 240000 };
	struct mesh pillar = make_pillar();

	(void)state;
	for (size_t i = 0; i < sizeof(budgets) / sizeof(budgets[0]); i++) {
		struct texmesh_report report;
		struct import_report imported;
		struct buffer file;
		struct mesh mesh;

		CHECK(make(&file, &pillar, budgets[i], false, &report) == 0);
		if (file.size > budgets[i] || (double)file.size < 0.95 * (double)budgets[i])
			fail_msg(
				"%zu bytes of %llu: %u triangles %llu pictures %llu, quality %u to %u, %u halvings",
				file.size, (unsigned long long)budgets[i], report.triangle_count,
				(unsigned long long)report.mesh_bytes,
				(unsigned long long)report.picture_bytes, report.quality_least,
				report.quality_most, report.halvings);
		read_back(&mesh, &file, &imported);
		assert_int_equal(imported.textures, 1);
		assert_in_range(mesh.triangle_count, report.triangle_count * 99 / 100,
				report.triangle_count);
		for (int k = 0; k < 3; k++) {
			static const float low[3] = { -1.06f, -1.06f, -0.001f };
			static const float high[3] = { 1.06f, 1.06f, 4.001f };

			CHECK(imported.low_m[k] >= low[k] && imported.high_m[k] <= high[k]);
		}
		CHECK(imported.high_m[2] > 3.99f);
		mesh_finish(&mesh);
		buffer_finish(&file);
	}
	mesh_finish(&pillar);
}

/* What the importer reads at a place of the picture is what was there. */
static void the_picture_is_where_it_was(void **state)
{
	struct mesh pillar = make_pillar(), mesh;
	struct texmesh_report report;
	struct buffer file;
	double error = 0;
	uint32_t count = 0;

	(void)state;
	/* a colour for each quarter of the height */
	for (uint32_t y = 0; y < SIDE_PX; y++)
		for (uint32_t x = 0; x < SIDE_PX; x++)
			pillar.textures[0].rgb[3 * (y * SIDE_PX + x)] =
				(uint8_t)(40 + 50 * (y * 4 / SIDE_PX));
	CHECK(make(&file, &pillar, 120000, false, &report) == 0);
	read_back(&mesh, &file, NULL);
	for (uint32_t i = 0; i < mesh.vertex_count; i++) {
		const float up = mesh.positions[i][2] / 4;
		const int quarter = (int)((1 - up) * 4);
		uint8_t rgb[3];

		if (fabsf((1 - up) * 4 - roundf((1 - up) * 4)) < 0.1f)
			continue;
		mesh_texel(&mesh.textures[0], mesh.uvs[i], rgb);
		error += abs(rgb[0] - (40 + 50 * quarter));
		count++;
	}
	if (count < 100 || error > 8 * count)
		fail_msg("colours of %u vertices are off by %g", count, error / count);
	mesh_finish(&mesh);
	mesh_finish(&pillar);
	buffer_finish(&file);
}

static void relief_gets_the_better_quality(void **state)
{
	struct mesh pillar = make_pillar();
	struct texmesh_report report;
	struct reduced_mesh whole;
	struct buffer file;
	uint32_t points[2] = { 0 };

	(void)state;
	CHECK(make(&file, &pillar, 80000, false, &report) == 0);
	CHECK(report.scale >= 1 && report.quality_most >= report.quality_least + 5);
	buffer_finish(&file);
	CHECK(make(&file, &pillar, 80000, true, &report) == 0);
	CHECK(report.scale == 0 && report.quality_most <= report.quality_least + 1);
	buffer_finish(&file);

	CHECK(reduced_mesh_copy(&whole, &pillar, (struct reduced_look){ 0 }) == 0);
	uint8_t *scales = malloc(whole.vertex_count);
	CHECK(vertex_scales_find(scales, &whole, &pillar) == 0);
	for (uint32_t i = 0; i < whole.vertex_count; i++) {
		const float z = whole.positions[i][2];

		/* the ends and the border of the relief are features too */
		if (z > 0.3f && z < 1.7f)
			points[0] += scales[i] > 0;
		if (z > 2.3f && z < 3.7f)
			points[1] += scales[i] > 0;
	}
	if (points[1] < 1000 || points[0] > points[1] / 10)
		fail_msg("%u feature points where it is smooth, %u on the relief", points[0],
			 points[1]);
	free(scales);
	reduced_mesh_finish(&whole);
	mesh_finish(&pillar);
}

/* Counts the sides of triangles that no other triangle shares, by places. */
static uint32_t count_open(const struct reduced_mesh *mesh)
{
	uint32_t open = 0;

	for (uint32_t i = 0; i < mesh->triangle_count; i++)
		for (int k = 0; k < 3; k++) {
			const float *a = mesh->positions[mesh->triangles[i][k]];
			const float *b = mesh->positions[mesh->triangles[i][(k + 1) % 3]];
			bool is_shared = false;

			for (uint32_t j = 0; j < mesh->triangle_count && !is_shared; j++)
				for (int m = 0; m < 3 && !is_shared; m++) {
					const uint32_t *t = mesh->triangles[j];

					is_shared = memcmp(a, mesh->positions[t[(m + 1) % 3]],
							   sizeof(float[3])) == 0 &&
						    memcmp(b, mesh->positions[t[m]],
							   sizeof(float[3])) == 0;
				}
			open += !is_shared;
		}
	return open;
}

static void a_seam_stays_closed(void **state)
{
	struct mesh pillar = make_pillar();
	struct reduced_mesh whole, reduced;
	uint32_t open, rims = 0;

	(void)state;
	CHECK(reduced_mesh_copy(&whole, &pillar, (struct reduced_look){ 0 }) == 0);
	CHECK(reduced_mesh_make(&reduced, &whole, 2000) == 0);
	assert_in_range(reduced.triangle_count, 1000, 2100);
	open = count_open(&reduced);
	for (uint32_t i = 0; i < reduced.triangle_count; i++)
		for (int k = 0; k < 3; k++) {
			const float a = reduced.positions[reduced.triangles[i][k]][2];
			const float b = reduced.positions[reduced.triangles[i][(k + 1) % 3]][2];

			rims += (a == 0 && b == 0) || (a == 4 && b == 4);
		}
	assert_int_equal(open, rims);
	reduced_mesh_finish(&reduced);
	reduced_mesh_finish(&whole);
	mesh_finish(&pillar);
}

static void colours_are_those_of_the_scan_around(void **state)
{
	struct mesh temple = shape_temple(60), mesh;
	struct texmesh_report report;
	struct buffer file;
	double error = 0;

	(void)state;
	CHECK(make(&file, &temple, 60000, false, &report) == 0);
	CHECK(file.size <= 60000 && file.size > 55000 && report.picture_count == 0);
	CHECK(report.triangle_count < temple.triangle_count);
	read_back(&mesh, &file, NULL);
	for (uint32_t i = 0; i < mesh.vertex_count; i++)
		for (int k = 0; k < 3; k++) {
			const float at = mesh.positions[i][k];

			error +=
				fabs(mesh.colours[i][k] - (128.0 + 60 * sin((3 + k) * (double)at)));
		}
	error /= 3.0 * mesh.vertex_count;
	if (error > 3)
		fail_msg("colours are off by %g in the mean", error);
	mesh_finish(&mesh);
	mesh_finish(&temple);
	buffer_finish(&file);
}

/* Black and white at random, which together give half of the light: hardly a vertex is either. */
static void colours_are_means(void **state)
{
	struct mesh temple = shape_temple(60), mesh;
	struct texmesh_report report;
	struct buffer file;
	uint32_t grey = 0;

	(void)state;
	for (uint32_t i = 0; i < temple.vertex_count; i++)
		memset(temple.colours[i], noise(i, 5) > 0.5f ? 255 : 0, 3);
	CHECK(make(&file, &temple, 20000, false, &report) == 0);
	read_back(&mesh, &file, NULL);
	CHECK(mesh.vertex_count > 100);
	for (uint32_t i = 0; i < mesh.vertex_count; i++)
		grey += mesh.colours[i][0] > 100 && mesh.colours[i][0] < 245;
	if (grey < 0.95 * mesh.vertex_count)
		fail_msg("%u of %u vertices are grey", grey, mesh.vertex_count);
	mesh_finish(&mesh);
	mesh_finish(&temple);
	buffer_finish(&file);
}

/* In place of the scan's picture it has the colours of the substance there. */
static void a_substance_takes_the_place_of_pictures(void **state)
{
	const struct texmesh_options options = { .budget_bytes = 400000,
						 .lit = true,
						 .look = { true, SUBSTANCE_LATERITE } };
	struct mesh pillar = make_pillar(), mesh;
	struct texmesh_report report;
	struct import_report imported;
	struct buffer file;
	double error = 0;

	(void)state;
	buffer_init(&file, TEXMESH_BUDGET_MOST_BYTES);
	CHECK(texmesh_make(&file, &pillar, &options, &report) == 0);
	CHECK(file.size <= 400000 && report.picture_count == 0);
	read_back(&mesh, &file, &imported);
	CHECK(imported.textures == 0 && imported.had_colours);
	for (uint32_t i = 0; i < mesh.vertex_count; i++) {
		float rgb[3];

		substance_colour(rgb, SUBSTANCE_LATERITE, mesh.positions[i], 0.04f);
		for (int k = 0; k < 3; k++)
			error += fabs((double)mesh.colours[i][k] - 255 * (double)rgb[k]);
	}
	error /= 3.0 * mesh.vertex_count;
	if (error > 6)
		fail_msg("colours are off by %g in the mean", error);
	mesh_finish(&mesh);
	mesh_finish(&pillar);
	buffer_finish(&file);
}

static void a_second_run_gives_the_same_bytes(void **state)
{
	struct mesh pillar = make_pillar();
	struct texmesh_report report;
	struct buffer files[2];

	(void)state;
	for (int i = 0; i < 2; i++)
		CHECK(make(&files[i], &pillar, 90000, false, &report) == 0);
	CHECK(bytes_equal(buffer_bytes(&files[0]), buffer_bytes(&files[1])));
	for (int i = 0; i < 2; i++)
		buffer_finish(&files[i]);
	mesh_finish(&pillar);
}

static void a_picture_that_nothing_shows_takes_nothing(void **state)
{
	struct mesh pillar = make_pillar();
	struct texmesh_report report;
	struct buffer file;

	(void)state;
	pillar.textures = realloc(pillar.textures, 2 * sizeof(*pillar.textures));
	pillar.textures[1] = (struct mesh_texture){ 1, 1, calloc(3, 1) };
	pillar.texture_count = 2;
	for (uint32_t i = 0; i < pillar.triangle_count; i++)
		pillar.materials[i] = 1;
	CHECK(make(&file, &pillar, 100000, false, &report) == 0);
	CHECK(report.picture_count == 0 && report.picture_bytes == 0);
	CHECK(file.size > 95000);
	buffer_finish(&file);
	mesh_finish(&pillar);
}

static void what_cannot_be_is_said(void **state)
{
	struct mesh pillar = make_pillar(), empty = { 0 };
	struct texmesh_report report;
	struct buffer file;

	(void)state;
	/* a thousand materials, whose description alone takes more */
	pillar.textures = realloc(pillar.textures, 1000 * sizeof(*pillar.textures));
	for (uint32_t i = 1; i < 1000; i++) {
		pillar.textures[i] = (struct mesh_texture){ 1, 1, calloc(3, 1) };
		pillar.materials[i] = (uint16_t)i;
	}
	pillar.texture_count = 1000;
	assert_int_equal(make(&file, &pillar, 100000, false, &report), -E2BIG);
	CHECK(report.least_bytes > 100000 && file.size == 0);
	buffer_finish(&file);
	CHECK(make(&file, &pillar, report.least_bytes, false, &report) == 0);
	buffer_finish(&file);
	assert_int_equal(make(&file, &empty, 100000, false, &report), -EINVAL);
	buffer_finish(&file);
	mesh_finish(&pillar);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_model_takes_its_budget),
		cmocka_unit_test(the_picture_is_where_it_was),
		cmocka_unit_test(relief_gets_the_better_quality),
		cmocka_unit_test(a_seam_stays_closed),
		cmocka_unit_test(colours_are_those_of_the_scan_around),
		cmocka_unit_test(colours_are_means),
		cmocka_unit_test(a_substance_takes_the_place_of_pictures),
		cmocka_unit_test(a_second_run_gives_the_same_bytes),
		cmocka_unit_test(a_picture_that_nothing_shows_takes_nothing),
		cmocka_unit_test(what_cannot_be_is_said),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
