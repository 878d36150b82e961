#include "pipeline/hierarchy/simplify_features.h"

#include "pipeline/hierarchy/feature_edges.h"
#include "tests/pipeline/hierarchy/subject.h"

/* A sheet of n x n squares where keep says so, in the plane z = 0. */
static struct mesh sheet(uint32_t n, bool (*keep)(uint32_t n, uint32_t x, uint32_t y))
{
	struct mesh mesh;

	shape_room(&mesh, (n + 1) * (n + 1), 2 * n * n);
	for (uint32_t y = 0; y <= n; y++)
		for (uint32_t x = 0; x <= n; x++) {
			uint32_t v =
				shape_vertex(&mesh, (float)x / (float)n, (float)y / (float)n, 0);

			memset(mesh.colours[v], 200, 4);
		}
	for (uint32_t y = 0; y < n; y++)
		for (uint32_t x = 0; x < n; x++) {
			uint32_t a = y * (n + 1) + x;

			if (!keep(n, x, y))
				continue;
			shape_triangle(&mesh, a, a + 1, a + n + 1);
			shape_triangle(&mesh, a + n + 1, a + 1, a + n + 2);
		}
	return mesh;
}

static bool everywhere(uint32_t n, uint32_t x, uint32_t y)
{
	(void)n;
	(void)x;
	(void)y;
	return true;
}

static bool in_comb(uint32_t n, uint32_t x, uint32_t y)
{
	return y < n / 4 || x / 4 % 2 == 0;
}

/* A cube of n x n squares a side, its sides between -1 and 1; bent: each side bulges a little. */
static struct mesh cube(uint32_t n, float bulge)
{
	struct mesh mesh;

	shape_room(&mesh, 6 * (n + 1) * (n + 1), 12 * n * n);
	for (uint32_t side = 0; side < 6; side++)
		for (uint32_t y = 0; y <= n; y++)
			for (uint32_t x = 0; x <= n; x++) {
				float u = 2.0f * (float)x / (float)n - 1.0f;
				float v = 2.0f * (float)y / (float)n - 1.0f, at[3];
				uint32_t a = mesh.vertex_count, axis = side % 3;
				float out = 1.0f + bulge * (1.0f - u * u) * (1.0f - v * v);

				at[axis] = side < 3 ? out : -out;
				at[(axis + 1) % 3] = side < 3 ? u : v;
				at[(axis + 2) % 3] = side < 3 ? v : u;
				shape_vertex(&mesh, at[0], at[1], at[2]);
				memset(mesh.colours[a], 200, 4);
				if (x == n || y == n)
					continue;
				shape_triangle(&mesh, a, a + 1, a + n + 1);
				shape_triangle(&mesh, a + n + 1, a + 1, a + n + 2);
			}
	return mesh;
}

static uint32_t used_vertices(const struct simplify_surface *surface)
{
	uint8_t *used = calloc(surface->vertex_count, 1);
	uint32_t count = 0;

	for (uint32_t c = 0; c < 3 * surface->triangle_count; c++) {
		uint8_t *mark = &used[surface->triangles[c / 3][c % 3]];

		count += !*mark;
		*mark = 1;
	}
	free(used);
	return count;
}

static void a_plane_becomes_two_triangles(void **state)
{
	struct subject subject;
	struct simplify_result result;
	double before;

	(void)state;
	subject_init(&subject, sheet(32, everywhere));
	before = subject_area(&subject.surface);
	CHECK(simplify_features(&subject.surface, 1, INFINITY, 0.5, &result) == 0);
	CHECK(subject.surface.triangle_count == 2);
	CHECK(used_vertices(&subject.surface) == 4);
	CHECK(fabs(subject_area(&subject.surface) - before) < 1e-9 * before);
	CHECK(result.error_steps < 1.0);
	CHECK(result.collapse_count == 33 * 33 - 4);
	subject_finish(&subject);
}

/* The edges of the cube stay where they were, to the last lattice step. */
static void a_cube_keeps_its_edges(void **state)
{
	struct subject subject;
	struct simplify_result result;
	double before;

	(void)state;
	subject_init(&subject, cube(16, 0.0f));
	before = subject_area(&subject.surface);
	CHECK(simplify_features(&subject.surface, 1, INFINITY, 0.5, &result) == 0);
	CHECK(subject.surface.triangle_count == 12);
	CHECK(used_vertices(&subject.surface) == 8);
	CHECK(fabs(subject_area(&subject.surface) - before) < 1e-9 * before);
	subject_finish(&subject);
}

/* What bulges slowly goes first; the edges are still sharp when most of it is gone. */
static void the_edges_of_bulging_sides_stay(void **state)
{
	struct subject subject;
	struct simplify_result result;
	uint32_t corners = 0;

	(void)state;
	subject_init(&subject, cube(24, 0.1f));
	CHECK(simplify_features(&subject.surface, 150, INFINITY, -1.0, &result) == 0);
	CHECK(subject.surface.triangle_count <= 150);
	for (uint32_t t = 0; t < subject.surface.triangle_count; t++)
		for (int corner = 0; corner < 3; corner++) {
			const struct lattice_vertex *vertex =
				&subject.surface.vertices[subject.surface.triangles[t][corner]];
			double far = 0.0;

			for (int i = 0; i < 3; i++)
				far += fabs(vertex->position[i] - 32768.0) > 0.89 * 32768.0;
			corners += far == 3.0;
		}
	CHECK(corners >= 24); /* three triangles and more at each of the eight */
	subject_finish(&subject);
}

/* A comb has reflex corners: collapses across the gaps between its teeth would fold or fill them.
 */
static void nothing_folds_over(void **state)
{
	struct subject subject;
	struct simplify_result result;
	double before, n[3];

	(void)state;
	subject_init(&subject, sheet(28, in_comb));
	before = subject_area(&subject.surface);
	CHECK(simplify_features(&subject.surface, 1, INFINITY, 0.5, &result) == 0);
	CHECK(subject.surface.triangle_count == 14); /* 16 corners */
	CHECK(fabs(subject_area(&subject.surface) - before) < 1e-9 * before);
	for (uint32_t t = 0; t < subject.surface.triangle_count; t++) {
		subject_cross(n, &subject.surface, t);
		CHECK(n[2] > 0.0);
	}
	subject_finish(&subject);
	subject_init(&subject, shape_relief(60));
	CHECK(simplify_features(&subject.surface, 300, INFINITY, -1.0, &result) == 0);
	CHECK(subject.surface.triangle_count <= 300);
	for (uint32_t t = 0; t < subject.surface.triangle_count; t++) {
		subject_cross(n, &subject.surface, t);
		CHECK(n[2] > 0.0);
	}
	subject_finish(&subject);
}

static bool but_one(uint32_t n, uint32_t x, uint32_t y)
{
	(void)n;
	return x != 10 || y != 12;
}

/* Vertices less edges plus triangles of an open surface: 1 for a disc, 0 with a hole. */
static int open_euler(const struct simplify_surface *surface)
{
	uint32_t corners = 3 * surface->triangle_count;
	uint64_t *edges = malloc(corners * sizeof(*edges));
	int distinct = 0;

	for (uint32_t c = 0; c < corners; c++) {
		uint64_t a = surface->triangles[c / 3][c % 3];
		uint64_t b = surface->triangles[c / 3][(c % 3 + 1) % 3];

		edges[c] = a < b ? a << 32 | b : b << 32 | a;
	}
	qsort(edges, corners, sizeof(*edges), subject_compare_keys);
	for (uint32_t c = 0; c < corners; c++)
		distinct += c == 0 || edges[c] != edges[c - 1];
	free(edges);
	return (int)used_vertices(surface) - distinct + (int)surface->triangle_count;
}

/* A hole of three edges: each two of its vertices have the third as a neighbour in common, which is
 * no corner of a triangle at their edge. Without the link condition the hole closes. */
static void a_small_hole_stays_a_hole(void **state)
{
	struct subject subject;
	struct simplify_result result;

	(void)state;
	subject_init(&subject, sheet(32, but_one));
	CHECK(open_euler(&subject.surface) == 0);
	CHECK(simplify_features(&subject.surface, 6, INFINITY, -1.0, &result) == 0);
	CHECK(subject.surface.triangle_count <= 6);
	CHECK(open_euler(&subject.surface) == 0);
	subject_finish(&subject);
}

/* Of two ends that may leave, the one in the flatter place does: the top of a low hill stays. */
static void the_flatter_end_leaves(void **state)
{
	struct subject subject;
	struct simplify_result result;
	struct mesh hill = sheet(32, everywhere);
	int32_t highest = 0;

	(void)state;
	hill.positions[17 * 33 + 15][2] = 0.2f / 32;
	subject_init(&subject, hill);
	CHECK(simplify_features(&subject.surface, 4, INFINITY, -1.0, &result) == 0);
	CHECK(subject.surface.triangle_count <= 4);
	for (uint32_t c = 0; c < 3 * subject.surface.triangle_count; c++) {
		uint32_t v = subject.surface.triangles[c / 3][c % 3];

		if (subject.surface.vertices[v].position[2] > highest)
			highest = subject.surface.vertices[v].position[2];
	}
	CHECK(highest > 100);
	subject_finish(&subject);
}

/* The ring, whose sides are far apart. */
static void a_ring_stays_a_ring(void **state)
{
	struct subject subject;
	struct simplify_result result;

	(void)state;
	subject_init(&subject, subject_ring(48));
	CHECK(simplify_features(&subject.surface, 80, INFINITY, -1.0, &result) == 0);
	CHECK(subject.surface.triangle_count <= 80);
	CHECK(subject_euler(&subject.surface) == 0);
	subject_finish(&subject);
}

static void a_locked_border_stays_edge_by_edge(void **state)
{
	struct subject subject;
	struct simplify_result result;
	struct lattice_vertex *before;
	struct subject_border border;

	(void)state;
	subject_init(&subject, shape_relief(40));
	before = malloc(subject.surface.vertex_count * sizeof(*before));
	subject_lock_border(&subject, &border);
	memcpy(before, subject.surface.vertices, subject.surface.vertex_count * sizeof(*before));
	CHECK(simplify_features(&subject.surface, 1, INFINITY, -1.0, &result) == 0);
	CHECK(result.collapse_count > 1000);
	subject_check_border(&subject, &border);
	/* A collapse changes no vertex that stays, locked or not. */
	CHECK(memcmp(before, subject.surface.vertices,
		     subject.surface.vertex_count * sizeof(*before)) == 0);
	free(before);
	subject_finish(&subject);
}

/* A step of colour on a flat sheet is the border of a material: its line stays, and what is on its
 * two sides does not mix. */
static void a_step_of_colour_stays(void **state)
{
	struct subject subject;
	struct simplify_result result;
	struct mesh mesh = sheet(32, everywhere);
	double dark = 0.0, all;

	(void)state;
	for (uint32_t v = 0; v < mesh.vertex_count; v++)
		if (mesh.positions[v][0] < 0.4f)
			memset(mesh.colours[v], 20, 3);
	subject_init(&subject, mesh);
	all = subject_area(&subject.surface);
	CHECK(simplify_features(&subject.surface, 1, INFINITY, 0.5, &result) == 0);
	CHECK(subject.surface.triangle_count < 200);
	for (uint32_t t = 0; t < subject.surface.triangle_count; t++) {
		double n[3], is_dark = 1.0;

		subject_cross(n, &subject.surface, t);
		for (int corner = 0; corner < 3; corner++)
			is_dark *= subject.surface.vertices[subject.surface.triangles[t][corner]]
					   .colour[0] == 20;
		dark += is_dark * n[2] / 2.0;
	}
	CHECK(fabs(dark / all - 12.0 / 32.0) < 0.005);
	subject_finish(&subject);
}

static void the_same_surface_gives_the_same_bytes(void **state)
{
	struct subject subjects[2];
	struct simplify_result results[2];

	(void)state;
	for (int i = 0; i < 2; i++) {
		subject_init(&subjects[i], shape_temple(40));
		CHECK(simplify_features(&subjects[i].surface, 700, INFINITY, -1.0, &results[i]) ==
		      0);
	}
	CHECK(subjects[0].surface.triangle_count <= 700);
	CHECK(subjects[0].surface.triangle_count == subjects[1].surface.triangle_count);
	CHECK(memcmp(subjects[0].surface.triangles, subjects[1].surface.triangles,
		     subjects[0].surface.triangle_count * sizeof(uint32_t[3])) == 0);
	CHECK(memcmp(&results[0], &results[1], sizeof(results[0])) == 0);
	for (int i = 0; i < 2; i++)
		subject_finish(&subjects[i]);
}

static void stops_at_the_error_it_may_make(void **state)
{
	struct subject subject;
	struct simplify_result result;

	(void)state;
	subject_init(&subject, shape_temple(40));
	CHECK(simplify_features(&subject.surface, 1, 40.0, -1.0, &result) == 0);
	CHECK(result.error_steps <= 40.0 && result.error_steps > 20.0);
	CHECK(subject.surface.triangle_count > 100);
	subject_finish(&subject);
}

static void pebbles_vanish_but_something_stays(void **state)
{
	struct subject subject;
	struct simplify_result result;

	(void)state;
	subject_init(&subject, shape_stones(100));
	CHECK(simplify_features(&subject.surface, 1, INFINITY, -1.0, &result) == 0);
	CHECK(subject.surface.triangle_count >= 1 && subject.surface.triangle_count <= 300);
	subject_finish(&subject);
}

/* ---- feature edges */

static void finds_the_edges_of_a_cube(void **state)
{
	struct collapse_mesh mesh;
	struct features features;
	struct subject subject;
	uint32_t sharp = 0, corners = 0, straight = 0, held = 0;

	(void)state;
	subject_init(&subject, cube(8, 0.0f));
	CHECK(collapse_mesh_init(&mesh, &subject.surface) == 0);
	CHECK(features_init(&features, &mesh) == 0);
	CHECK(features_find(&features, 0.5) == 0);
	CHECK(features.edge_count == 3 * subject.surface.triangle_count / 2);
	for (uint32_t e = 0; e < features.edge_count; e++) {
		sharp += features.edges[e].is_sharp;
		CHECK(!features.edges[e].is_open);
		CHECK(features.edges[e].is_sharp || features.edges[e].weight > 0.999f);
	}
	for (uint32_t v = 0; v < subject.surface.vertex_count; v++) {
		corners += features.vertices[v].line_count == 3;
		held += features.vertices[v].is_held;
		if (features.vertices[v].line_count == 2)
			straight += features_straightness(&features, v) > 0.999;
	}
	CHECK(sharp == 12 * 8 && corners == 8 && straight == 12 * 7 && held == 0);
	/* Nothing is sharp at right angles below their cosine; then the normals of ends decide. */
	CHECK(features_find(&features, -0.5) == 0);
	for (uint32_t e = 0; e < features.edge_count; e++)
		CHECK(!features.edges[e].is_sharp);
	features_finish(&features);
	collapse_mesh_finish(&mesh);
	subject_finish(&subject);
}

/* The sides of a ridge whose angle is below the crease's: the base edges run across it. */
static void holds_the_ends_of_base_edges(void **state)
{
	struct collapse_mesh mesh;
	struct features features;
	struct subject subject;
	struct mesh roof = sheet(16, everywhere);
	uint32_t held = 0;

	(void)state;
	for (uint32_t v = 0; v < roof.vertex_count; v++)
		roof.positions[v][2] = 0.5f - fabsf(roof.positions[v][0] - 0.5f);
	subject_init(&subject, roof);
	CHECK(collapse_mesh_init(&mesh, &subject.surface) == 0);
	CHECK(features_init(&features, &mesh) == 0);
	/* The cosine of the ridge is 0; that of its normals and those beside it, about a half. */
	CHECK(features_find(&features, -0.1) == 0);
	for (uint32_t v = 0; v < subject.surface.vertex_count; v++)
		held += features.vertices[v].is_held;
	CHECK(held == 0);
	for (uint32_t e = 0; e < features.edge_count; e++)
		if (!features.edges[e].is_sharp && features.edges[e].weight < 0.6f)
			held++;
	CHECK(held >= 2 * 15);
	features_finish(&features);
	collapse_mesh_finish(&mesh);
	subject_finish(&subject);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_plane_becomes_two_triangles),
		cmocka_unit_test(a_cube_keeps_its_edges),
		cmocka_unit_test(the_edges_of_bulging_sides_stay),
		cmocka_unit_test(nothing_folds_over),
		cmocka_unit_test(a_small_hole_stays_a_hole),
		cmocka_unit_test(the_flatter_end_leaves),
		cmocka_unit_test(a_ring_stays_a_ring),
		cmocka_unit_test(a_locked_border_stays_edge_by_edge),
		cmocka_unit_test(a_step_of_colour_stays),
		cmocka_unit_test(the_same_surface_gives_the_same_bytes),
		cmocka_unit_test(stops_at_the_error_it_may_make),
		cmocka_unit_test(pebbles_vanish_but_something_stays),
		cmocka_unit_test(finds_the_edges_of_a_cube),
		cmocka_unit_test(holds_the_ends_of_base_edges),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
