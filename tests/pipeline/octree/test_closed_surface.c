#include "pipeline/octree/closed_surface.h"

#include <errno.h>
#include <string.h>

#include "base/map.h"
#include "tests/check.h"
#include "tests/pipeline/octree/dirty_boxes.h"

/* ---- what must be true */

/* Each edge is there once in each direction. */
static bool is_watertight(const struct mesh *mesh)
{
	struct map edges = { 0 };
	bool is_closed = true;

	for (uint32_t t = 0; t < mesh->triangle_count && is_closed; t++)
		for (int i = 0; i < 3; i++) {
			const map_key from = mesh->triangles[t][i];
			const map_key to = mesh->triangles[t][(i + 1) % 3];

			is_closed &= map_add(&edges, from << 32 | to, 1) == 1;
		}
	for (uint32_t t = 0; t < mesh->triangle_count && is_closed; t++)
		for (int i = 0; i < 3; i++) {
			const map_key from = mesh->triangles[t][i];
			const map_key to = mesh->triangles[t][(i + 1) % 3];

			is_closed &= map_get(&edges, to << 32 | from) != MAP_NONE;
		}
	map_finish(&edges);
	return is_closed;
}

static double volume_of(const struct mesh *mesh)
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
	return sum / 6;
}

static double area_of(const struct mesh *mesh)
{
	double sum = 0;

	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		double a[3], b[3], squared = 0;

		for (int k = 0; k < 3; k++) {
			const float *first = mesh->positions[mesh->triangles[t][0]];

			a[k] = (double)(mesh->positions[mesh->triangles[t][1]][k] - first[k]);
			b[k] = (double)(mesh->positions[mesh->triangles[t][2]][k] - first[k]);
		}
		for (int k = 0; k < 3; k++) {
			const int m = (k + 1) % 3, n = (k + 2) % 3;

			squared += (a[m] * b[n] - a[n] * b[m]) * (a[m] * b[n] - a[n] * b[m]);
		}
		sum += sqrt(squared) / 2;
	}
	return sum;
}

static void close_it(struct mesh *mesh, double cell_m, struct closed_surface_report *report)
{
	struct diagnostics diagnostics = { 0 };
	const int rc = closed_surface_make(mesh, cell_m, report, &diagnostics);

	if (rc < 0)
		fail_msg("%s", diagnostics_cause(&diagnostics, rc));
	CHECK(is_watertight(mesh));
}

/* ---- tests */

/* The bodies and their union, whose volume and area are known. */
static void boxes_that_overlap_become_their_union(void **state)
{
	static const struct box clean[] = {
		{ .low = { 0, 0, 0 }, .size = { 1, 1, 1 }, .steps = 20 },
		{ .low = { 0.51f, 0.51f, 0.51f }, .size = { 1, 1, 1 }, .steps = 20 },
		{ .low = { 0.26f, 0.27f, 0.28f }, .size = { 0.5f, 0.5f, 0.5f }, .steps = 10 },
	};
	static const double volume = 2 - 0.49 * 0.49 * 0.49;
	static const double area = 12 - 6 * 0.49 * 0.49;
	(void)state;

	for (int dirty = 0; dirty < 2; dirty++) {
		struct mesh mesh = boxes_begin();
		struct closed_surface_report report;

		for (size_t i = 0; i < ARRAY_COUNT(clean); i++) {
			struct box box = clean[i];

			box.is_turned = dirty && i != 1;
			box.missing = dirty ? 0.02 : 0;
			box.doubled = dirty ? 0.1 : 0;
			box_add(&mesh, &box);
		}
		close_it(&mesh, 0.03, &report);
		print_message("%s: %u shells, %u turned, %u twice, %u parts; volume %.4f of %.4f, "
			      "area %.4f of %.4f; %.3f inside\n",
			      dirty ? "dirty" : "clean", report.shells, report.turned_shells,
			      report.copies, report.parts, volume_of(&mesh), volume, area_of(&mesh),
			      area, report.inner_share);
		CHECK(report.parts == 1);
		CHECK(dirty ? report.copies > 100 : report.copies == 0 && report.shells == 3);
		CHECK(dirty ? report.turned_shells >= 2 : report.turned_shells == 0);
		CHECK(fabs(volume_of(&mesh) - volume) < 0.01 * volume);
		CHECK(fabs(area_of(&mesh) - area) < 0.04 * area);
		/* the third box, and a quarter of three sides of each of the others */
		CHECK(fabs(report.inner_share - (1.5 + 6 * 0.49 * 0.49) / 13.5) < 0.03);
		CHECK(report.sheet_share < 0.01);
		mesh_finish(&mesh);
	}
}

/* As the wall of a cup has no thickness, what closes it is a guess; but it is closed. */
static void a_box_without_a_lid_gets_one(void **state)
{
	const struct box box = {
		.low = { 0, 0, 0 }, .size = { 1, 1, 1 }, .steps = 30, .is_lidless = true
	};
	struct closed_surface_report report;
	struct mesh mesh = boxes_begin();
	(void)state;

	box_add(&mesh, &box);
	close_it(&mesh, 0.05, &report);
	print_message("volume %.3f, area %.3f\n", volume_of(&mesh), area_of(&mesh));
	CHECK(report.parts == 1 && report.turned_shells == 0);
	CHECK(volume_of(&mesh) > 0.8 && volume_of(&mesh) < 1);
	mesh_finish(&mesh);
}

/* Stones, each open or closed, outwards or inside out. */
static void shells_are_turned_outwards(void **state)
{
	struct mesh mesh = boxes_begin();
	struct closed_surface_report report;
	uint32_t turned = 0;
	enum { STONES = 200 };
	(void)state;

	for (int i = 0; i < STONES; i++) {
		const struct box box = { .low = { (float)(i % 15), (float)(i / 15 % 15),
						  (float)(i / 225) },
					 .size = { 0.5f, 0.6f, 0.7f },
					 .steps = 1,
					 .is_turned = box_chance(0.5),
					 .is_lidless = box_chance(0.5) };

		turned += box.is_turned;
		box_add(&mesh, &box);
	}
	close_it(&mesh, 0.15, &report);
	print_message("%u shells, %u of %u turned, %u parts, volume %.1f of %.1f\n", report.shells,
		      report.turned_shells, turned, report.parts, volume_of(&mesh),
		      STONES * 0.5 * 0.6 * 0.7);
	CHECK(report.shells == STONES && report.turned_shells == turned);
	CHECK(report.parts == STONES && volume_of(&mesh) > 0.8 * STONES * 0.5 * 0.6 * 0.7);
	mesh_finish(&mesh);
}

/* Whatever the triangles are, no edge is open. */
static void a_soup_of_triangles_becomes_closed_too(void **state)
{
	(void)state;
	for (int round = 0; round < 6; round++) {
		struct mesh mesh = boxes_begin();
		struct closed_surface_report report;
		struct diagnostics diagnostics = { 0 };
		const struct box body = { .low = { 0.2f, 0.2f, 0.2f },
					  .size = { 0.6f, 0.6f, 0.6f },
					  .steps = 4,
					  .missing = 0.1 };
		int rc;

		srand((unsigned)round);
		box_add(&mesh, &body);
		for (int t = 0; t < 20 * round; t++) {
			for (int i = 0; i < 3; i++)
				shape_vertex(&mesh, (float)rand() / (float)RAND_MAX,
					     (float)rand() / (float)RAND_MAX,
					     (float)rand() / (float)RAND_MAX);
			shape_triangle(&mesh, mesh.vertex_count - 3, mesh.vertex_count - 2,
				       mesh.vertex_count - 1);
		}
		rc = closed_surface_make(&mesh, 0.05, &report, &diagnostics);
		CHECK(rc == -EINVAL || (rc == 0 && is_watertight(&mesh)));
		CHECK(round > 1 || rc == 0);
		mesh_finish(&mesh);
	}
}

static void colours_of_vertices_and_of_pictures_stay(void **state)
{
	const struct box box = { .low = { 0, 0, 0 }, .size = { 1, 1, 1 }, .steps = 20 };
	(void)state;

	for (int with_picture = 0; with_picture < 2; with_picture++) {
		struct mesh mesh = boxes_begin();
		struct closed_surface_report report;
		double green = 0;
		int count = 0;

		box_add(&mesh, &box);
		if (with_picture) {
			/* stripes finer than a cube, black and white, red from left to right */
			enum { WIDE = 512, HIGH = 256 };
			struct mesh_texture *picture = calloc(1, sizeof(*picture));

			*picture = (struct mesh_texture){ WIDE, HIGH, malloc(3 * WIDE * HIGH) };
			for (int i = 0; i < WIDE * HIGH; i++) {
				picture->rgb[3 * i] = (uint8_t)(i % WIDE / 2);
				picture->rgb[3 * i + 1] = i / WIDE % 2 ? 255 : 0;
				picture->rgb[3 * i + 2] = 9;
			}
			mesh.textures = picture;
			mesh.texture_count = 1;
			mesh.materials = calloc(mesh.triangle_count, sizeof(*mesh.materials));
			mesh.uvs = calloc(mesh.vertex_count, sizeof(*mesh.uvs));
			for (uint32_t v = 0; v < mesh.vertex_count; v++) {
				mesh.uvs[v][0] = 0.02f + 0.96f * mesh.positions[v][0];
				mesh.uvs[v][1] = 0.02f + 0.96f * mesh.positions[v][2];
			}
		}
		close_it(&mesh, 0.03, &report);
		CHECK(mesh.colours && !mesh.textures && !mesh.uvs && !mesh.materials);
		for (uint32_t v = 0; v < mesh.vertex_count; v++) {
			const float *at = mesh.positions[v];
			const uint8_t *colour = mesh.colours[v];
			const bool is_on_side = at[1] < 0.02f && at[0] > 0.1f && at[0] < 0.9f &&
						at[2] > 0.1f && at[2] < 0.9f;

			CHECK(colour[3] == 255);
			if (!with_picture) {
				CHECK(fabsf(colour[0] - (128 + 60 * sinf(3 * at[0]))) < 4);
			} else if (is_on_side) {
				CHECK(abs(colour[0] - (int)(5 + 245 * at[0])) < 8 &&
				      colour[2] == 9);
				green += colour[1];
				count++;
			}
		}
		CHECK(!with_picture || fabs(green / count - 127) < 12);
		mesh_finish(&mesh);
	}
}

/* Two scans, the first one's faces numbered backwards. */
static void triangles_keep_scan_and_number_of_the_nearest_face(void **state)
{
	const struct box left = { .low = { 0, 0, 0 }, .size = { 1, 1, 1 }, .steps = 8 };
	const struct box right = {
		.low = { 3, 0, 0 }, .size = { 1, 1, 1 }, .steps = 8, .doubled = 0.1
	};
	struct mesh mesh = boxes_begin(), before = boxes_begin();
	struct closed_surface_report report;
	uint32_t first;
	(void)state;

	for (int copy = 0; copy < 2; copy++) {
		struct mesh *to = copy ? &before : &mesh;

		srand(7);
		box_add(to, &left);
		first = to->triangle_count;
		box_add(to, &right);
	}
	mesh.scan_count = 2;
	mesh.scans[0] = (struct mesh_scan){ first, first };
	mesh.scans[1] = (struct mesh_scan){ mesh.triangle_count - first, 0 };
	mesh.faces = malloc(mesh.triangle_count * sizeof(*mesh.faces));
	for (uint32_t t = 0; t < mesh.triangle_count; t++)
		mesh.faces[t] = t < first ? first - 1 - t : MESH_NO_FACE;
	close_it(&mesh, 0.06, &report);
	CHECK(report.copies > 10 && mesh.scan_count == 2 && mesh.faces);
	CHECK(mesh.scans[0].face_count == first && mesh.scans[1].face_count == 0);
	CHECK(mesh.scans[0].triangle_count + mesh.scans[1].triangle_count == mesh.triangle_count);
	for (uint32_t t = 0; t < mesh.triangle_count; t++) {
		const bool is_left = t < mesh.scans[0].triangle_count;

		CHECK(is_left == (mesh.positions[mesh.triangles[t][0]][0] < 2));
		CHECK(is_left ? mesh.faces[t] < first : mesh.faces[t] == MESH_NO_FACE);
		for (int k = 0; k < 3 && is_left; k++) {
			const uint32_t *near = before.triangles[first - 1 - mesh.faces[t]];

			CHECK(fabsf(before.positions[near[0]][k] -
				    mesh.positions[mesh.triangles[t][0]][k]) < 0.25f);
		}
	}
	mesh_finish(&mesh);
	mesh_finish(&before);
}

static void refuses(struct mesh mesh, double cell_m, const char *words)
{
	struct closed_surface_report report;
	struct diagnostics diagnostics = { 0 };

	CHECK(closed_surface_make(&mesh, cell_m, &report, &diagnostics) == -EINVAL);
	if (!strstr(diagnostics.first.text, words))
		fail_msg("%s", diagnostics.first.text);
	mesh_finish(&mesh);
}

static void what_has_no_area_is_refused(void **state)
{
	const struct box small = { .size = { 1, 1, 1 }, .steps = 1 };
	struct mesh line = boxes_begin(), box = boxes_begin();
	(void)state;

	for (int i = 0; i < 3; i++)
		shape_vertex(&line, (float)i, 0, 0);
	shape_triangle(&line, 0, 1, 2);
	refuses(line, 0.1, "have no area");
	box_add(&box, &small);
	refuses(box, 1e-6, "correct the unit");
}

/* A relief of 2 m by 2 m with a hole in it becomes a plate whose front is the relief. */
static void a_sheet_becomes_a_plate(void **state)
{
	static const double cell = 0.02, hole = 0.16;
	struct closed_surface_report report;
	struct mesh mesh = shape_relief(60);
	const double area = area_of(&mesh);
	(void)state;

	close_it(&mesh, cell, &report);
	print_message("sheet %.2f, volume %.4f of %.4f, area %.3f of %.3f\n", report.sheet_share,
		      volume_of(&mesh), 1.5 * cell * area, area_of(&mesh), 2 * area);
	CHECK(report.sheet_share > 0.5 && report.parts == 1);
	CHECK(volume_of(&mesh) > 0.8 * 1.5 * cell * area &&
	      volume_of(&mesh) < 1.2 * 1.5 * cell * area);
	CHECK(area_of(&mesh) > 1.9 * area && area_of(&mesh) < 2.3 * (area + hole));
	mesh_finish(&mesh);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(boxes_that_overlap_become_their_union),
		cmocka_unit_test(a_box_without_a_lid_gets_one),
		cmocka_unit_test(shells_are_turned_outwards),
		cmocka_unit_test(a_soup_of_triangles_becomes_closed_too),
		cmocka_unit_test(colours_of_vertices_and_of_pictures_stay),
		cmocka_unit_test(triangles_keep_scan_and_number_of_the_nearest_face),
		cmocka_unit_test(a_sheet_becomes_a_plate),
		cmocka_unit_test(what_has_no_area_is_refused),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
