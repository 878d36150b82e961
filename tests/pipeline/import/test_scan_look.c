/* What a look at a scan's file tells, against files whose contents are known. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "pipeline/import/scan_look.h"
#include "tests/check.h"

enum { SIDE = 60, VERTICES = (SIDE + 1) * (SIDE + 1), QUADS = SIDE * SIDE };

static char path[64];
static struct scan_look look;
static const struct import_options plain;

static FILE *begin(const char *extension)
{
	FILE *file;

	snprintf(path, sizeof(path), "/tmp/gopura-look-%d%s", (int)getpid(), extension);
	file = fopen(path, "w");
	CHECK(file != NULL);
	return file;
}

static int take(FILE *file, const struct import_options *options)
{
	struct diagnostics diagnostics = { 0 };
	int rc;

	fclose(file);
	rc = scan_look(&look, path, options, &diagnostics);
	CHECK(rc == 0 || diagnostics.count > 0);
	unlink(path);
	return rc;
}

static float height(int v)
{
	return 0.25f + (float)(v % 7);
}

/* A sheet of squares with its corners at 0 0 and SIDE SIDE. */
static void put_header(FILE *file, const char *encoding)
{
	fprintf(file,
		"ply\nformat %s 1.0\nelement vertex %d\nproperty float x\nproperty float y\n"
		"property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
		"element face %d\nproperty list uchar int vertex_indices\nend_header\n",
		encoding, VERTICES, QUADS);
}

static void corners_of(int quad, int corner[4])
{
	int a = quad / SIDE * (SIDE + 1) + quad % SIDE;

	corner[0] = a;
	corner[1] = a + 1;
	corner[2] = a + SIDE + 2;
	corner[3] = a + SIDE + 1;
}

/* The places are vertices of the sheet, from all of it. */
static void check_places(void)
{
	float most = 0;

	CHECK(look.place_count > 100);
	for (uint32_t i = 0; i < look.place_count; i++) {
		const float *place = look.places_m[i];

		CHECK(place[0] >= 0 && place[0] <= SIDE && place[1] >= 0 && place[1] <= SIDE);
		CHECK(place[2] >= 0.25f && place[2] <= 6.25f);
		most = place[1] > most ? place[1] : most;
	}
	CHECK(most > SIDE * 0.9f);
}

static bool near(uint64_t a, uint64_t b)
{
	return a * 10 > b * 9 && b * 10 > a * 9;
}

static void counts_the_triangles_of_a_binary_ply_of_squares(void **state)
{
	FILE *file = begin(".ply");

	(void)state;
	put_header(file, "binary_little_endian");
	for (int v = 0; v < VERTICES; v++) {
		float place[3] = { (float)(v % (SIDE + 1)), (float)(v / (SIDE + 1)), height(v) };

		fwrite(place, sizeof(place), 1, file);
		fwrite("abc", 3, 1, file);
	}
	for (int q = 0; q < QUADS; q++) {
		int corner[4];

		corners_of(q, corner);
		fputc(4, file);
		fwrite(corner, sizeof(corner), 1, file);
	}
	CHECK(take(file, &plain) == 0);
	CHECK(strcmp(look.format, "PLY") == 0 && look.is_counted && look.has_colours);
	CHECK(look.triangle_count == 2 * QUADS && look.vertex_count == VERTICES);
	CHECK(!look.is_text && !look.has_pictures);
	check_places();
}

static void reads_places_of_a_ply_of_text(void **state)
{
	FILE *file = begin(".ply");

	(void)state;
	put_header(file, "ascii");
	for (int v = 0; v < VERTICES; v++)
		fprintf(file, "%d.0 %d.0 %.2f 1 2 3\n", v % (SIDE + 1), v / (SIDE + 1),
			(double)height(v));
	for (int q = 0; q < QUADS; q++) {
		int corner[4];

		corners_of(q, corner);
		fprintf(file, "4 %d %d %d %d\n", corner[0], corner[1], corner[2], corner[3]);
	}
	CHECK(take(file, &plain) == 0);
	CHECK(look.is_text && look.vertex_count == VERTICES && look.triangle_count == QUADS);
	check_places();
}

static void estimates_the_counts_of_an_obj(void **state)
{
	FILE *file = begin(".obj");

	(void)state;
	fputs("mtllib a.mtl\n", file);
	for (int v = 0; v < VERTICES; v++)
		fprintf(file, "v %d.0 %d.0 %.2f\n", v % (SIDE + 1), v / (SIDE + 1),
			(double)height(v));
	for (int v = 0; v < VERTICES; v++)
		fprintf(file, "vt 0.5 0.5\n");
	for (int q = 0; q < QUADS; q++) {
		int corner[4];

		corners_of(q, corner);
		fprintf(file, "f %d/%d %d/%d %d/%d %d/%d\n", corner[0], corner[0], corner[1],
			corner[1], corner[2], corner[2], corner[3], corner[3]);
	}
	CHECK(take(file, &plain) == 0);
	CHECK(look.is_text && !look.is_counted && look.has_pictures);
	CHECK(near(look.triangle_count, 2 * QUADS) && near(look.vertex_count, VERTICES));
	check_places();
}

static void counts_the_triangles_of_a_binary_stl_in_metres(void **state)
{
	static const struct import_options options = { .up = IMPORT_Y_UP, .metres_per_unit = 0.01 };
	const uint8_t head[80] = { 0 };
	uint32_t count = 500;
	FILE *file = begin(".stl");

	(void)state;
	fwrite(head, sizeof(head), 1, file);
	fwrite(&count, sizeof(count), 1, file);
	for (uint32_t i = 0; i < count; i++) {
		float values[12] = { 0, 0, 1, (float)i, 200, 300, 1, 2, 3, 4, 5, 6 };

		fwrite(values, sizeof(values), 1, file);
		fwrite("ab", 2, 1, file);
	}
	CHECK(take(file, &options) == 0);
	CHECK(look.triangle_count == count && look.is_counted && look.place_count == count);
	CHECK(fabsf(look.places_m[499][0] - 4.99f) < 1e-5f);
	CHECK(fabsf(look.places_m[499][1] + 3.0f) < 1e-5f);
	CHECK(fabsf(look.places_m[499][2] - 2.0f) < 1e-5f);
}

static void counts_the_faces_of_an_off(void **state)
{
	FILE *file = begin(".off");

	(void)state;
	fputs("OFF\n# a comment\n4 2 0\n0.0 0.0 0.5\n1.0 0.0 0.5\n1.0 1.0 0.5\n0.0 1.0 0.5\n"
	      "3 0 1 2\n3 0 2 3\n",
	      file);
	CHECK(take(file, &plain) == 0);
	CHECK(look.triangle_count == 2 && look.vertex_count == 4);
	CHECK(look.place_count == 4 && look.places_m[2][1] == 1);
}

static void reads_the_boxes_of_a_gltf(void **state)
{
	FILE *file = begin(".gltf");

	(void)state;
	fputs("{\"asset\":{\"version\":\"2.0\"},\"accessors\":[{\"min\":[-1,-2,-3],"
	      "\"max\":[1.5, 2, 3]}],\"buffers\":[{\"byteLength\":2800},{\"byteLength\": 2800}]}",
	      file);
	CHECK(take(file, &plain) == 0);
	CHECK(look.triangle_count == 200 && !look.is_counted && look.place_count == 2);
	CHECK(look.places_m[1][0] == 1.5f && !look.has_pictures);
}

static void refuses_what_the_import_would_refuse(void **state)
{
	FILE *file = begin(".ply");

	(void)state;
	put_header(file, "binary_little_endian"); /* and nothing else */
	CHECK(take(file, &plain) == -EBADMSG);
	file = begin(".gltf");
	fputs("{\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]}", file);
	CHECK(take(file, &plain) == -ENOTSUP);
	CHECK(take(begin(".obj"), &plain) == -EBADMSG);
	file = begin(".xyz");
	fputs("1 2 3\n", file);
	CHECK(take(file, &plain) == -EINVAL);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(counts_the_triangles_of_a_binary_ply_of_squares),
		cmocka_unit_test(reads_places_of_a_ply_of_text),
		cmocka_unit_test(estimates_the_counts_of_an_obj),
		cmocka_unit_test(counts_the_triangles_of_a_binary_stl_in_metres),
		cmocka_unit_test(counts_the_faces_of_an_off),
		cmocka_unit_test(reads_the_boxes_of_a_gltf),
		cmocka_unit_test(refuses_what_the_import_would_refuse),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
