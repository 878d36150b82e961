#include "pipeline/octree/reconstruct.h"

#include <errno.h>
#include <string.h>
#include <sys/resource.h>

#include "tests/check.h"
#include "tests/pipeline/import/scan_text.h"
#include "tests/pipeline/octree/bumpy_ball.h"

enum { VIEWS = 14, GRID = 64 };

static char folder_file[256]; /* names the folder of the scans */
static char paths[VIEWS][320];
static struct transform places[VIEWS];
static struct reconstruct_scan scans[VIEWS];

static void make_scans(double noise_m)
{
	scan_write(folder_file, "about", "", 0);
	srand(1);
	for (int v = 0; v < VIEWS; v++) {
		snprintf(paths[v], sizeof(paths[v]), "%.*s/view-%d.ply",
			 (int)(strrchr(folder_file, '/') - folder_file), folder_file, v);
		ball_write(paths[v], v, GRID, noise_m, v % 2 == 1);
		places[v] = ball_view(v);
		scans[v] = (struct reconstruct_scan){ paths[v], &places[v] };
	}
}

static double rms_m(const struct mesh *mesh, double *worst)
{
	double sum = 0;

	*worst = 0;
	for (uint32_t i = 0; i < mesh->vertex_count; i++) {
		const double at[3] = { (double)mesh->positions[i][0], (double)mesh->positions[i][1],
				       (double)mesh->positions[i][2] };
		const double off = fabs(ball_outside(at));

		sum += off * off;
		*worst = fmax(*worst, off);
	}
	return sqrt(sum / mesh->vertex_count);
}

/* Six times the volume that a mesh encloses: above 0 if its triangles face outwards. */
static double volume6(const struct mesh *mesh)
{
	double sum = 0;

	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		const float *a = mesh->positions[mesh->triangles[t][0]];
		const float *b = mesh->positions[mesh->triangles[t][1]];
		const float *c = mesh->positions[mesh->triangles[t][2]];

		for (int k = 0; k < 3; k++)
			sum += (double)a[k] * (double)(b[(k + 1) % 3] * c[(k + 2) % 3] -
						       b[(k + 2) % 3] * c[(k + 1) % 3]);
	}
	return sum;
}

static struct mesh run(const struct reconstruct_options *options, uint32_t count,
		       struct reconstruct_report *report)
{
	struct diagnostics diagnostics = { 0 };
	struct mesh mesh;
	const int rc = reconstruct(&mesh, scans, count, options, report, &diagnostics);

	if (rc < 0)
		fail_msg("%s", diagnostics_cause(&diagnostics, rc));
	return mesh;
}

/* Noise is averaged over the 5 to 10 points around each corner, and over the scans. */
static void finds_the_true_surface_without_and_with_noise(void **state)
{
	static const struct {
		double noise_m, rms_most_m, worst_most_m;
	} cases[] = { { 0, 0.0006, 0.002 }, { 0.001, 0.0008, 0.003 }, { 0.005, 0.002, 0.008 } };
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		struct reconstruct_options options = { .cell = 0.025 };

		make_scans(cases[i].noise_m);
		for (int closed = 0; closed < 2; closed++) {
			struct reconstruct_report report;
			struct mesh mesh;
			double rms, worst;

			options.is_closed = closed;
			mesh = run(&options, VIEWS, &report);
			rms = rms_m(&mesh, &worst);
			print_message("noise %g mm, %s: rms %.3f mm, worst %.2f mm, %u triangles, "
				      "%u parts, %u border edges\n",
				      1000 * cases[i].noise_m, closed ? "closed" : "open",
				      1000 * rms, 1000 * worst, mesh.triangle_count, report.parts,
				      report.border_edges);
			CHECK(rms < cases[i].rms_most_m && worst < cases[i].worst_most_m);
			CHECK(report.parts == 1 && report.border_edges == 0 &&
			      report.crowded_edges == 0);
			CHECK(report.range_images == VIEWS && mesh.triangle_count > 8000);
			CHECK(volume6(&mesh) > 6 * 0.5 && volume6(&mesh) < 6 * 0.55);
			mesh_finish(&mesh);
		}
		scan_remove(folder_file);
	}
}

static void keeps_colours(void **state)
{
	const struct reconstruct_options options = { .cell = 0.025 };
	struct reconstruct_report report;
	struct mesh mesh;
	(void)state;

	make_scans(0);
	mesh = run(&options, VIEWS, &report);
	CHECK(mesh.colours);
	for (uint32_t i = 0; i < mesh.vertex_count; i++) {
		const double expected = 127 + 200 * (double)mesh.positions[i][0];

		CHECK(fabs(mesh.colours[i][2] - expected) < 6 && mesh.colours[i][1] == 100);
	}
	mesh_finish(&mesh);
	scan_remove(folder_file);
}

/* One view sees half of the ball: open, there is nothing behind; closed, no edge is open. */
static void is_open_or_watertight_as_asked(void **state)
{
	struct reconstruct_options options = { .cell = 0.025 };
	struct reconstruct_report report;
	struct mesh mesh;
	(void)state;

	make_scans(0);
	mesh = run(&options, 1, &report);
	CHECK(report.border_edges > 100);
	for (uint32_t i = 0; i < mesh.vertex_count; i++)
		CHECK(mesh.positions[i][0] > -0.15f);
	mesh_finish(&mesh);
	for (uint32_t count = 1; count < VIEWS; count += 4) {
		options.is_closed = true;
		mesh = run(&options, count, &report);
		CHECK(report.border_edges == 0 && report.crowded_edges == 0);
		CHECK(volume6(&mesh) > 0);
		mesh_finish(&mesh);
	}
	scan_remove(folder_file);
}

/* In coordinates of a map, floats are half a metre apart. */
static void refuses_scans_far_from_the_origin_with_a_cure(void **state)
{
	struct reconstruct_options options = { .cell = 0.1 };
	struct diagnostics diagnostics = { 0 };
	struct reconstruct_report report;
	struct mesh mesh;
	(void)state;

	make_scans(0);
	for (int v = 0; v < VIEWS; v++)
		places[v].rows[1][3] = 5400000;
	CHECK(reconstruct(&mesh, scans, VIEWS, &options, &report, &diagnostics) == -EINVAL);
	CHECK(strstr(diagnostics.first.text, "move all scans by the same way to the origin"));
	CHECK(mesh.triangle_count == 0);
	for (int v = 0; v < VIEWS; v++)
		places[v].rows[1][3] = 5400;
	mesh = run(&options, VIEWS, &report);
	CHECK(report.parts == 1 && report.border_edges == 0);
	mesh_finish(&mesh);
	scan_remove(folder_file);
}

static void depth_sets_the_number_of_cubes(void **state)
{
	const struct reconstruct_options options = { .depth = 5 };
	struct reconstruct_report report;
	struct mesh mesh;
	(void)state;

	make_scans(0);
	mesh = run(&options, VIEWS, &report);
	CHECK(fabs(report.cell * 32 - (report.high[0] - report.low[0])) < 0.1);
	mesh_finish(&mesh);
	scan_remove(folder_file);
}

/* ---- one file */

static int read_text(const char *text, struct diagnostics *diagnostics)
{
	struct range_scan scan;
	char path[256];
	int rc;

	*diagnostics = (struct diagnostics){ 0 };
	scan_write(path, "one.ply", text, strlen(text));
	rc = range_scan_read(&scan, path, NULL, RANGE_SIGHT_AUTO, diagnostics);
	CHECK(rc < 0 || scan.count > 0);
	CHECK((rc < 0) == (strstr(diagnostics->first.text, "one.ply") != NULL));
	range_scan_finish(&scan);
	scan_remove(path);
	return rc;
}

static void refuses_what_is_no_scan_with_a_cure(void **state)
{
#define HEAD         "ply\nformat ascii 1.0\n"
#define XYZ          "property float x\nproperty float y\nproperty float z\n"
#define GRID_ELEMENT "property list uchar int vertex_indices\nend_header\n"
	static const struct {
		const char *name, *text, *says;
	} cases[] = {
		{ "points", HEAD "element vertex 1\n" XYZ "end_header\n0 0 0\n",
		  "compute normals" },
		{ "nothing", HEAD "element vertex 0\n" XYZ "end_header\n", "no points" },
		{ "cells",
		  HEAD "obj_info num_cols 3\nobj_info num_rows 2\nelement vertex 1\n" XYZ
		       "element range_grid 4\n" GRID_ELEMENT "0 0 0\n0\n0\n0\n0\n",
		  "has 4 cells" },
		{ "index",
		  HEAD "obj_info num_cols 2\nobj_info num_rows 1\nelement vertex 1\n" XYZ
		       "element range_grid 2\n" GRID_ELEMENT "0 0 0\n1 7\n0\n",
		  "range_grid 0: names vertex 7" },
		{ "cut",
		  HEAD "obj_info num_cols 2\nobj_info num_rows 1\nelement vertex 1\n" XYZ
		       "element range_grid 2\n" GRID_ELEMENT "0 0 0\n1 0\n",
		  "copy it again" },
		{ "no-neighbours",
		  HEAD "obj_info num_cols 2\nobj_info num_rows 1\nelement vertex 2\n" XYZ
		       "element range_grid 2\n" GRID_ELEMENT "0 0 1\n1 0 1\n1 0\n1 1\n",
		  "none of its points" },
		{ "nan",
		  HEAD "element vertex 1\n" XYZ "property float nx\nproperty float ny\n"
		       "property float nz\nend_header\nnan 0 0 0 0 1\n",
		  "none of its points" },
	};
	struct diagnostics diagnostics;
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(cases); i++)
		if (read_text(cases[i].text, &diagnostics) != -EBADMSG ||
		    !strstr(diagnostics.first.text, cases[i].says))
			fail_msg("%s: '%s'", cases[i].name, diagnostics.first.text);
}

static void reads_clouds_with_normals_and_meshes(void **state)
{
	struct diagnostics diagnostics;
	(void)state;

	CHECK(read_text(HEAD "element vertex 2\n" XYZ "property float nx\nproperty float ny\n"
			     "property float nz\nproperty float confidence\nend_header\n"
			     "0 0 0 0 0 2 1\n1 0 0 0 0 2 0\n",
			&diagnostics) == 0);
	CHECK(read_text(HEAD "element vertex 3\n" XYZ "element face 1\n"
			     "property list uchar int vertex_indices\nend_header\n"
			     "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
			&diagnostics) == 0);
}

/* A range_grid whose cells name no vertices is skipped, as any element that is not known. */
static void a_grid_without_vertices_is_no_range_image(void **state)
{
	struct diagnostics diagnostics;
	(void)state;

	CHECK(read_text(HEAD "element vertex 1\n" XYZ "property float nx\nproperty float ny\n"
			     "property float nz\nelement range_grid 2\nproperty uchar seen\n"
			     "end_header\n0 0 0 0 0 1\n1\n0\n",
			&diagnostics) == 0);
	CHECK(read_text(HEAD "obj_info num_cols 2\nobj_info num_rows 2\nelement vertex 4\n" XYZ
			     "element range_grid 6\nproperty uchar seen\nend_header\n"
			     "0 0 0.1\n1 0 0\n0 1 0\n1 1 0.1\n1\n1\n1\n1\n1\n1\n",
			&diagnostics) == 0);
}

/* Its corners alone would be 40 cubes apart. Edges are rounded by half a cube. */
static void faces_of_a_mesh_give_points(void **state)
{
	static const char text[] =
		HEAD "element vertex 8\n" XYZ "element face 6\n"
		     "property list uchar int vertex_indices\nend_header\n"
		     "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 0 1\n1 0 1\n0 1 1\n1 1 1\n"
		     "4 0 2 3 1\n4 4 5 7 6\n4 0 1 5 4\n4 2 6 7 3\n4 0 4 6 2\n4 1 3 7 5\n";
	const struct reconstruct_options options = { .cell = 0.025, .is_closed = true };
	struct reconstruct_report report;
	struct mesh mesh;
	char path[256];
	(void)state;

	scan_write(path, "box.ply", text, strlen(text));
	scans[0] = (struct reconstruct_scan){ path, NULL };
	mesh = run(&options, 1, &report);
	CHECK(report.parts == 1 && report.border_edges == 0 && report.crowded_edges == 0);
	CHECK(fabs(volume6(&mesh) / 6 - 1) < 0.01);
	for (uint32_t i = 0; i < mesh.vertex_count; i++) {
		float outside = 0;

		for (int k = 0; k < 3; k++)
			outside = fmaxf(outside, fabsf(mesh.positions[i][k] - 0.5f));
		CHECK(outside > 0.4f && outside < 0.5f + 0.012f);
	}
	mesh_finish(&mesh);
	scan_remove(path);
}

/* Writes a ball of half a metre radius as a cloud: points on a spiral, whose distance is everywhere
 * the same, or at random. Without colours, or all of one. */
static void write_cloud(const char *path, int count, bool is_even, const uint8_t *colour)
{
	FILE *file = fopen(path, "wb");

	CHECK(file != NULL);
	srand(1);
	fprintf(file,
		HEAD "element vertex %d\n" XYZ "property float nx\nproperty float ny\n"
		     "property float nz\n%send_header\n",
		count,
		colour ? "property uchar red\nproperty uchar green\nproperty uchar blue\n" : "");
	for (int i = 0; i < count; i++) {
		const double even_z = (2 * i + 1.0) / count - 1;
		const double z = is_even ? even_z : 2.0 * rand() / RAND_MAX - 1;
		const double turn = is_even ? 2.399963 * i : 6.283185 * rand() / RAND_MAX;
		const double n[3] = { sqrt(1 - z * z) * cos(turn), sqrt(1 - z * z) * sin(turn), z };

		fprintf(file, "%.7f %.7f %.7f %.5f %.5f %.5f", n[0] / 2, n[1] / 2, n[2] / 2, n[0],
			n[1], n[2]);
		if (colour)
			fprintf(file, " %d %d %d", colour[0], colour[1], colour[2]);
		fputc('\n', file);
	}
	CHECK(fclose(file) == 0);
}

/* One point of a ball of n is alone on pi / n square metres. */
static void cubes_are_as_fine_as_a_cloud(void **state)
{
	const struct reconstruct_options options = { 0 };
	struct reconstruct_report report;
	struct mesh mesh;
	double worst;
	(void)state;

	for (int n = 0; n < 6; n++) {
		const int count = n % 3 == 0 ? 500 : n % 3 == 1 ? 20000 : 400000;
		const double apart = sqrt(3.14159265 / count);

		scan_write(folder_file, "ball.ply", "", 0);
		write_cloud(folder_file, count, n < 3, NULL);
		scans[0] = (struct reconstruct_scan){ folder_file, NULL };
		mesh = run(&options, 1, &report);
		print_message("%d points %.2f mm apart: %.2f mm found, %u triangles\n", count,
			      1000 * apart, 1000 * report.spacing, mesh.triangle_count);
		CHECK(fabs(report.spacing / apart - 1) < 0.25);
		CHECK(fabs(report.cell / report.spacing - 1.5) < 0.001);
		CHECK(report.parts == 1 && report.border_edges == 0 && report.crowded_edges == 0);
		worst = 0;
		for (uint32_t i = 0; i < mesh.vertex_count; i++) {
			const float *at = mesh.positions[i];

			worst = fmax(worst, fabs(sqrt((double)(at[0] * at[0] + at[1] * at[1] +
							       at[2] * at[2])) -
						 0.5));
		}
		CHECK(worst < 0.2 * report.cell);
		mesh_finish(&mesh);
		scan_remove(folder_file);
	}
}

static rlim_t data_bytes(void)
{
	unsigned long pages = 0;
	FILE *file = fopen("/proc/self/statm", "r");

	CHECK(file && fscanf(file, "%*s %*s %*s %*s %*s %lu", &pages) == 1 && fclose(file) == 0);
	return pages * (rlim_t)sysconf(_SC_PAGESIZE);
}

/* Its points take 128 MB, of 100 more that the process may have. */
static void a_cloud_may_be_larger_than_memory(void **state)
{
	enum { POINTS = 2000000 };
	struct diagnostics diagnostics = { 0 };
	struct rlimit before, little;
	struct range_scan scan;
	FILE *file;
	int rc;
	(void)state;

	scan_write(folder_file, "large.ply", "", 0);
	file = fopen(folder_file, "wb");
	CHECK(file != NULL);
	fprintf(file,
		"ply\nformat binary_little_endian 1.0\nelement vertex %d\n" XYZ
		"property float nx\nproperty float ny\nproperty float nz\nend_header\n",
		POINTS);
	for (int i = 0; i < POINTS; i++) {
		const float place[6] = { (float)(i % 2000), (float)(i / 2000), 0, 0, 0, 1 };

		CHECK(fwrite(place, sizeof(place), 1, file) == 1);
	}
	CHECK(fclose(file) == 0 && getrlimit(RLIMIT_DATA, &before) == 0);
	little = before;
	little.rlim_cur = data_bytes() + (100 << 20);
	CHECK(setrlimit(RLIMIT_DATA, &little) == 0);
	rc = range_scan_read(&scan, folder_file, NULL, RANGE_SIGHT_AUTO, &diagnostics);
	CHECK(setrlimit(RLIMIT_DATA, &before) == 0);
	if (rc < 0)
		fail_msg("%s", diagnostics_cause(&diagnostics, rc));
	CHECK(scan.count == POINTS && scan.points[POINTS - 1].at[0] == 1999);
	CHECK(fabs(scan.spacing - 1) < 0.25);
	range_scan_finish(&scan);
	scan_remove(folder_file);
}

/* One that has none beside it must not make it paler; and black is a colour. */
static void a_scan_without_colours_leaves_those_of_others(void **state)
{
	static const uint8_t colours[2][3] = { { 180, 60, 20 }, { 0, 0, 0 } };
	const struct reconstruct_options options = { .cell = 0.05 };
	struct reconstruct_report report;
	struct mesh mesh;
	char plain[320];
	(void)state;

	scan_write(folder_file, "coloured.ply", "", 0);
	snprintf(plain, sizeof(plain), "%s-plain.ply", folder_file);
	write_cloud(plain, 20000, true, NULL);
	for (int i = 0; i < 4; i++) {
		const uint8_t *colour = colours[i / 2];

		write_cloud(folder_file, 20000, true, colour);
		scans[i % 2] = (struct reconstruct_scan){ folder_file, NULL };
		scans[1 - i % 2] = (struct reconstruct_scan){ plain, NULL };
		mesh = run(&options, 2, &report);
		for (uint32_t v = 0; v < mesh.vertex_count; v++)
			for (int k = 0; k < 3; k++)
				CHECK(abs(mesh.colours[v][k] - colour[k]) <= 1);
		mesh_finish(&mesh);
	}
	scan_remove(folder_file);
}

/* Meshes with normals at their vertices, which most programs write, are meshes too; and one that is
 * placed in a mirror keeps its outside. */
static void normals_and_mirrors_leave_a_mesh_what_it_is(void **state)
{
	static const char text[] =
		HEAD "element vertex 8\n" XYZ "property float nx\nproperty float ny\n"
		     "property float nz\nelement face 6\n"
		     "property list uchar int vertex_indices\nend_header\n"
		     "0 0 0 -1 -1 -1\n1 0 0 1 -1 -1\n0 1 0 -1 1 -1\n1 1 0 1 1 -1\n"
		     "0 0 1 -1 -1 1\n1 0 1 1 -1 1\n0 1 1 -1 1 1\n1 1 1 1 1 1\n"
		     "4 0 2 3 1\n4 4 5 7 6\n4 0 1 5 4\n4 2 6 7 3\n4 0 4 6 2\n4 1 3 7 5\n";
	static const struct transform mirror = {
		{ { -1, 0, 0, 0 }, { 0, 1, 0, 0 }, { 0, 0, 1, 0 } }
	};
	const struct reconstruct_options options = { .cell = 0.05, .is_closed = true };
	struct reconstruct_report report;
	struct mesh mesh;
	char path[256];
	(void)state;

	scan_write(path, "box.ply", text, strlen(text));
	for (int i = 0; i < 2; i++) {
		scans[0] = (struct reconstruct_scan){ path, i ? &mirror : NULL };
		mesh = run(&options, 1, &report);
		CHECK(report.parts == 1 && report.border_edges == 0);
		CHECK(fabs(volume6(&mesh) / 6 - 1) < 0.03);
		mesh_finish(&mesh);
	}
	scan_remove(path);
}

static void faces_may_come_before_their_corners(void **state)
{
	static const char text[] = HEAD "element face 1\n"
					"property list uchar int vertex_indices\n"
					"element vertex 3\n" XYZ "end_header\n"
					"3 0 1 2\n0 0 0\n1 0 0\n0 1 0\n";
	struct diagnostics diagnostics = { 0 };
	struct range_scan scan;
	char path[256];
	(void)state;

	scan_write(path, "one.ply", text, strlen(text));
	CHECK(range_scan_read(&scan, path, NULL, RANGE_SIGHT_AUTO, &diagnostics) == 0);
	CHECK(scan.count == 3 && scan.triangle_count == 1);
	for (uint32_t i = 0; i < 3; i++)
		CHECK(scan.points[i].normal[2] == 1 && scan.points[i].at[2] == 0);
	range_scan_finish(&scan);
	scan_remove(path);
}

static void registrations_place_the_scans(void **state)
{
	struct diagnostics diagnostics = { 0 };
	struct range_scan scan;
	struct transform turn = { { { 0, -1, 0, 5 }, { 1, 0, 0, 0 }, { 0, 0, 1, 0 } } };
	static const char text[] =
		HEAD "element vertex 1\n" XYZ "property float nx\nproperty float ny\n"
		     "property float nz\nend_header\n1 2 3 1 0 0\n";
	char path[256];
	(void)state;

	scan_write(path, "one.ply", text, strlen(text));
	CHECK(range_scan_read(&scan, path, &turn, RANGE_SIGHT_ORIGIN, &diagnostics) == 0);
	CHECK(scan.points[0].at[0] == 3 && scan.points[0].at[1] == 1);
	CHECK(scan.points[0].normal[1] == 1 && fabsf(scan.points[0].towards[0] - 0.534f) < 0.001f);
	range_scan_finish(&scan);
	scan_remove(path);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(finds_the_true_surface_without_and_with_noise),
		cmocka_unit_test(keeps_colours),
		cmocka_unit_test(is_open_or_watertight_as_asked),
		cmocka_unit_test(refuses_scans_far_from_the_origin_with_a_cure),
		cmocka_unit_test(depth_sets_the_number_of_cubes),
		cmocka_unit_test(refuses_what_is_no_scan_with_a_cure),
		cmocka_unit_test(reads_clouds_with_normals_and_meshes),
		cmocka_unit_test(a_grid_without_vertices_is_no_range_image),
		cmocka_unit_test(faces_of_a_mesh_give_points),
		cmocka_unit_test(cubes_are_as_fine_as_a_cloud),
		cmocka_unit_test(a_cloud_may_be_larger_than_memory),
		cmocka_unit_test(a_scan_without_colours_leaves_those_of_others),
		cmocka_unit_test(normals_and_mirrors_leave_a_mesh_what_it_is),
		cmocka_unit_test(faces_may_come_before_their_corners),
		cmocka_unit_test(registrations_place_the_scans),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
