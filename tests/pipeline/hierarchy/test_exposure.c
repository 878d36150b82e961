#include "pipeline/hierarchy/exposure.h"

#include <stdlib.h>

#include "pipeline/hierarchy/simplify.h"
#include "tests/check.h"
#include "tests/pipeline/on_lattice.h"
#include "tests/pipeline/shapes.h"

enum { SIDE = 12, BOX_VERTICES = 6 * (SIDE + 1) * (SIDE + 1), BOX_TRIANGLES = 12 * SIDE * SIDE };

/* A closed box, each face a grid; inwards: its triangles turned over. */
static void add_box(struct mesh *mesh, const float centre[3], float half, bool inwards)
{
	for (int face = 0; face < 6; face++) {
		int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
		uint32_t first = mesh->vertex_count;
		bool turned = (face % 2 == 0) != inwards;

		for (int i = 0; i <= SIDE; i++)
			for (int j = 0; j <= SIDE; j++) {
				float at[3];

				at[axis] = centre[axis] + (face % 2 ? half : -half);
				at[u] = centre[u] + half * (2 * (float)i / SIDE - 1);
				at[v] = centre[v] + half * (2 * (float)j / SIDE - 1);
				shape_vertex(mesh, at[0], at[1], at[2]);
			}
		for (uint32_t i = 0; i < SIDE; i++)
			for (uint32_t j = 0; j < SIDE; j++) {
				uint32_t a = first + i * (SIDE + 1) + j, b = a + SIDE + 1;

				shape_triangle(mesh, a, turned ? b + 1 : b, turned ? b : b + 1);
				shape_triangle(mesh, a, turned ? a + 1 : b + 1,
					       turned ? b + 1 : a + 1);
			}
	}
}

/* A box of 2 m with one of 1 m in it. */
static void make(struct lattice_mesh *out, bool inwards)
{
	const float middle[3] = { 0, 0, 0 };
	struct lattice_counts counts;
	struct mesh mesh;

	shape_room(&mesh, 2 * BOX_VERTICES, 2 * BOX_TRIANGLES);
	add_box(&mesh, middle, 1, inwards);
	add_box(&mesh, middle, 0.5f, inwards);
	CHECK(on_lattice(out, &counts, &mesh) == 0);
	mesh_finish(&mesh);
}

static void add_triangle(struct exposure *exposure, const struct lattice_mesh *mesh, uint32_t t)
{
	uint16_t corners[3][3];

	for (int c = 0; c < 3; c++)
		for (int k = 0; k < 3; k++)
			corners[c][k] = (uint16_t)mesh->vertices[mesh->triangles[t][c]].position[k];
	exposure_add(exposure, (const uint16_t(*)[3])corners);
}

/* backwards: everything in the other order. */
static void look(struct lattice_mesh *mesh, bool backwards)
{
	struct exposure *exposure;

	CHECK(exposure_create(&exposure) == 0);
	for (uint32_t t = 0; t < mesh->triangle_count; t++)
		add_triangle(exposure, mesh, backwards ? mesh->triangle_count - 1 - t : t);
	CHECK(exposure_close(exposure) == 0);
	for (uint32_t i = 0; i < mesh->vertex_count; i++) {
		struct lattice_vertex *vertex =
			&mesh->vertices[backwards ? mesh->vertex_count - 1 - i : i];
		uint16_t coarse[3];

		lattice_coarse(coarse, &mesh->lattice, vertex->position);
		vertex->seen = exposure_of(exposure, coarse, vertex->normal);
	}
	exposure_destroy(exposure);
}

static bool is_inside(const struct lattice_vertex *vertex)
{
	for (int k = 0; k < 3; k++)
		if (vertex->position[k] < 4096 || vertex->position[k] > 61440)
			return false;
	return true;
}

struct mean {
	uint32_t sum, count;
};

/* Of the outer box the lid and a side are seen, its foot and the inner box are not. */
static void check_boxes(const struct lattice_mesh *mesh)
{
	struct mean lid = { 0 }, side = { 0 }, foot = { 0 };

	for (uint32_t v = 0; v < mesh->vertex_count; v++) {
		const struct lattice_vertex *vertex = &mesh->vertices[v];
		struct mean *mean = fabsf(vertex->normal[0]) > 0.99f   ? &side
				    : fabsf(vertex->normal[2]) < 0.99f ? NULL
				    : vertex->position[2] == 0         ? &foot
								       : &lid;

		if (is_inside(vertex)) {
			CHECK(vertex->seen == 0);
		} else if (mean) {
			mean->sum += vertex->seen;
			mean->count++;
		}
	}
	CHECK(lid.count > 50 && side.count > 100 && foot.count > 50);
	/* A third of the viewpoints lie above the lid, at a cosine of 0.3 or so; twice the mean. */
	CHECK(lid.sum > 30 * lid.count && lid.sum < 80 * lid.count);
	CHECK(side.sum > 30 * side.count && side.sum < 120 * side.count);
	CHECK(foot.sum == 0);
}

static void what_is_inside_is_not_seen(void **state)
{
	struct lattice_mesh mesh;

	(void)state;
	for (int inwards = 0; inwards < 2; inwards++) { /* scans do not always know what is out */
		make(&mesh, inwards);
		CHECK(mesh.vertices[0].seen == 255); /* until it is found */
		look(&mesh, false);
		check_boxes(&mesh);
		lattice_mesh_finish(&mesh);
	}
}

static void the_order_changes_nothing(void **state)
{
	struct lattice_mesh one, other;

	(void)state;
	make(&one, false);
	make(&other, false);
	look(&one, false);
	look(&other, true);
	for (uint32_t v = 0; v < one.vertex_count; v++)
		CHECK(one.vertices[v].seen == other.vertices[v].seen);
	lattice_mesh_finish(&one);
	lattice_mesh_finish(&other);
}

/* How many of the triangles that are left belong to the inner box. Both are crumpled alike, so that
 * every triangle is worth something. */
static uint32_t left_inside(bool exposed)
{
	struct lattice_mesh mesh;
	struct simplify_result result;
	struct simplify_surface surface;
	uint32_t inside = 0;

	make(&mesh, false);
	if (exposed)
		look(&mesh, false);
	for (uint32_t v = 0; v < mesh.vertex_count; v++)
		for (uint32_t k = 0; k < 3; k++)
			mesh.vertices[v].position[k] = 512 +
						       mesh.vertices[v].position[k] / 66 * 64 +
						       (int32_t)((v * 7919 + k * 104729) % 509);
	surface = (struct simplify_surface){ .vertex_count = mesh.vertex_count,
					     .triangle_count = mesh.triangle_count,
					     .vertices = mesh.vertices,
					     .locked = calloc(mesh.vertex_count, 1),
					     .triangles = mesh.triangles };
	CHECK(simplify(&surface, BOX_TRIANGLES / 2, INFINITY, &result) == 0);
	for (uint32_t t = 0; t < surface.triangle_count; t++)
		inside += is_inside(&mesh.vertices[surface.triangles[t][0]]);
	free(surface.locked);
	lattice_mesh_finish(&mesh);
	return inside;
}

static void what_is_not_seen_gets_few_triangles(void **state)
{
	uint32_t before = left_inside(false), after = left_inside(true);

	(void)state;
	CHECK(after < before * 2 / 3);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_is_inside_is_not_seen),
		cmocka_unit_test(the_order_changes_nothing),
		cmocka_unit_test(what_is_not_seen_gets_few_triangles),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
