#include "pipeline/hierarchy/simplify.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/pipeline/hierarchy/subject.h"

static void a_flat_sheet_needs_few_triangles(void **state)
{
	struct subject subject;
	struct simplify_result result;
	double before;

	(void)state;
	subject_init(&subject, subject_flat(32));
	before = subject_area(&subject.surface);
	CHECK(simplify(&subject.surface, 60, INFINITY, &result) == 0);
	CHECK(subject.surface.triangle_count <= 60);
	CHECK(result.error_steps < 3.0);
	CHECK(result.collapse_count > 900);
	/* Outline and hole are where they were. */
	CHECK(fabs(subject_area(&subject.surface) - before) < 1e-3 * before);
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
	CHECK(simplify(&subject.surface, 1, INFINITY, &result) == 0);
	CHECK(result.collapse_count > 1000);
	subject_check_border(&subject, &border);
	for (uint32_t v = 0; v < subject.surface.vertex_count; v++)
		CHECK(!subject.surface.locked[v] ||
		      memcmp(&before[v], &subject.surface.vertices[v], sizeof(*before)) == 0);
	free(before);
	subject_finish(&subject);
}

static void nothing_folds_over(void **state)
{
	struct subject subject;
	struct simplify_result result;
	double n[3];

	(void)state;
	subject_init(&subject, shape_relief(60));
	CHECK(simplify(&subject.surface, 300, INFINITY, &result) == 0);
	CHECK(subject.surface.triangle_count <= 300);
	for (uint32_t t = 0; t < subject.surface.triangle_count; t++) {
		subject_cross(n, &subject.surface, t);
		CHECK(n[2] > 0.0);
	}
	subject_finish(&subject);
}

static void a_ring_stays_a_ring(void **state)
{
	struct subject subject;
	struct simplify_result result;

	(void)state;
	subject_init(&subject, subject_ring(48));
	CHECK(subject_euler(&subject.surface) == 0);
	CHECK(simplify(&subject.surface, 120, INFINITY, &result) == 0);
	CHECK(subject.surface.triangle_count <= 120);
	CHECK(subject_euler(&subject.surface) == 0);
	subject_finish(&subject);
}

/* Squared distance from p to the triangle: to its edges, and to its plane above it. */
static double distance_to_triangle(const double p[3], const struct simplify_surface *surface,
				   uint32_t t)
{
	double best = INFINITY, at[3][3], n[3], length;

	for (int corner = 0; corner < 3; corner++)
		subject_place(at[corner], surface, t, corner);
	for (int e = 0; e < 3; e++) {
		const double *a = at[e], *b = at[(e + 1) % 3];
		double along = 0.0, square = 0.0, rest = 0.0, s;

		for (int i = 0; i < 3; i++) {
			along += (p[i] - a[i]) * (b[i] - a[i]);
			square += (b[i] - a[i]) * (b[i] - a[i]);
		}
		s = square > 0.0 ? fmin(fmax(along / square, 0.0), 1.0) : 0.0;
		for (int i = 0; i < 3; i++) {
			double d = p[i] - a[i] - s * (b[i] - a[i]);

			rest += d * d;
		}
		best = fmin(best, rest);
	}
	subject_cross(n, surface, t);
	length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
	if (length > 0.0) {
		bool inside = true;
		double off = 0.0;

		for (int e = 0; e < 3; e++) {
			const double *a = at[e], *b = at[(e + 1) % 3];
			double u[3], v[3], side = 0.0;

			for (int i = 0; i < 3; i++) {
				u[i] = b[i] - a[i];
				v[i] = p[i] - a[i];
			}
			for (int i = 0; i < 3; i++)
				side += n[i] * (u[(i + 1) % 3] * v[(i + 2) % 3] -
						u[(i + 2) % 3] * v[(i + 1) % 3]);
			inside = inside && side >= 0.0;
		}
		for (int i = 0; i < 3; i++)
			off += n[i] / length * (p[i] - at[0][i]);
		if (inside)
			best = fmin(best, off * off);
	}
	return best;
}

static void the_error_is_honest(void **state)
{
	struct subject subject;
	struct simplify_result result;
	struct lattice_vertex *before;
	uint32_t beyond = 0;
	double worst = 0.0;

	(void)state;
	subject_init(&subject, shape_temple(40));
	before = malloc(subject.surface.vertex_count * sizeof(*before));
	memcpy(before, subject.surface.vertices, subject.surface.vertex_count * sizeof(*before));
	CHECK(simplify(&subject.surface, subject.surface.triangle_count / 8, INFINITY, &result) ==
	      0);
	for (uint32_t v = 0; v < subject.surface.vertex_count; v++) {
		double at[3] = { before[v].position[0], before[v].position[1],
				 before[v].position[2] };
		double best = INFINITY;

		for (uint32_t t = 0; t < subject.surface.triangle_count; t++)
			best = fmin(best, distance_to_triangle(at, &subject.surface, t));
		worst = fmax(worst, sqrt(best));
		beyond += sqrt(best) > result.error_steps;
	}
	print_message("error %.1f steps; %.2f %% of the vertices are farther, at most %.1f\n",
		      result.error_steps, 100.0 * beyond / subject.surface.vertex_count, worst);
	CHECK(beyond < subject.surface.vertex_count / 50);
	CHECK(worst < 4.0 * result.error_steps);
	CHECK(worst > 0.25 * result.error_steps);
	free(before);
	subject_finish(&subject);
}

static void pebbles_vanish_but_something_stays(void **state)
{
	struct subject subject;
	struct simplify_result result;

	(void)state;
	subject_init(&subject, shape_stones(100));
	CHECK(simplify(&subject.surface, 300, INFINITY, &result) == 0);
	CHECK(subject.surface.triangle_count <= 300);
	CHECK(simplify(&subject.surface, 1, INFINITY, &result) == 0);
	CHECK(subject.surface.triangle_count >= 1 && subject.surface.triangle_count <= 8);
	subject_finish(&subject);
}

/* Each face of a leaf or a banner is often there twice, once from each side. */
static void a_sheet_that_is_there_from_both_sides_gets_no_hole(void **state)
{
	struct mesh mesh = subject_flat(32);
	const uint32_t count = mesh.triangle_count;
	struct simplify_result result;
	struct subject subject;
	double before;

	(void)state;
	mesh.triangles = realloc(mesh.triangles, 2 * count * sizeof(*mesh.triangles));
	for (uint32_t t = 0; t < count; t++)
		shape_triangle(&mesh, mesh.triangles[t][1], mesh.triangles[t][0],
			       mesh.triangles[t][2]);
	subject_init(&subject, mesh);
	before = subject_area(&subject.surface);
	CHECK(simplify(&subject.surface, count / 4, INFINITY, &result) == 0);
	CHECK(fabs(subject_area(&subject.surface) - before) < 1e-3 * before);
	subject_finish(&subject);
}

static void stops_at_the_error_it_may_make(void **state)
{
	struct subject subject;
	struct simplify_result result;

	(void)state;
	subject_init(&subject, shape_temple(40));
	CHECK(simplify(&subject.surface, 1, 40.0, &result) == 0);
	CHECK(result.error_steps <= 40.0 && result.error_steps > 20.0);
	CHECK(subject.surface.triangle_count > 100);
	subject_finish(&subject);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_flat_sheet_needs_few_triangles),
		cmocka_unit_test(a_locked_border_stays_edge_by_edge),
		cmocka_unit_test(nothing_folds_over),
		cmocka_unit_test(a_ring_stays_a_ring),
		cmocka_unit_test(the_error_is_honest),
		cmocka_unit_test(pebbles_vanish_but_something_stays),
		cmocka_unit_test(a_sheet_that_is_there_from_both_sides_gets_no_hole),
		cmocka_unit_test(stops_at_the_error_it_may_make),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
