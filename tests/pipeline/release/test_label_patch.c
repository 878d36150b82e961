/* What a patch is told of the parts on it, against what is known of balls and boxes. */
#include "pipeline/release/label_patch.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "format/normal.h"
#include "geometry/vec.h"
#include "pipeline/import/mesh.h"
#include "tests/check.h"
#include "tests/pipeline/toy.h"

enum { STEPS = 4096 };

static const struct lattice lattice = { .origin_m = { -2, -2, -2 }, .step_m = 4.0 / STEPS };
static const uint8_t grey[3] = { 128, 128, 128 };

/* ---- scans and patches of n x n squares */

/* A square of -1..1 at height z, showing up or down. */
static void add_sheet(struct mesh *mesh, uint32_t n, float z, bool up)
{
	uint32_t first = mesh->vertex_count;

	for (uint32_t y = 0; y <= n; y++)
		for (uint32_t x = 0; x <= n; x++)
			toy_vertex(mesh, 2 * (float)x / (float)n - 1, 2 * (float)y / (float)n - 1,
				   z, grey);
	for (uint32_t y = 0; y < n; y++)
		for (uint32_t x = 0; x < n; x++) {
			uint32_t a = first + y * (n + 1) + x, b = a + 1, c = a + n + 1, d = c + 1;

			toy_triangle(mesh, a, up ? b : c, up ? c : b);
			toy_triangle(mesh, c, up ? b : d, up ? d : b);
		}
}

static struct mesh sheet(uint32_t n, float z)
{
	struct mesh mesh = toy_empty((n + 1) * (n + 1), 2 * n * n);

	add_sheet(&mesh, n, z, true);
	return mesh;
}

/* As the hierarchy would make of it, but for simplification. */
static struct patch_mesh patch_of(const struct mesh *mesh)
{
	struct patch_mesh out = { mesh->vertex_count, mesh->triangle_count, NULL, NULL };

	out.vertices = calloc(out.vertex_count, sizeof(*out.vertices));
	out.indices = calloc(3 * out.triangle_count, sizeof(*out.indices));
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		const uint32_t *c = mesh->triangles[t];
		float ab[3], ac[3], normal[3];

		vec_sub(ab, mesh->positions[c[1]], mesh->positions[c[0]]);
		vec_sub(ac, mesh->positions[c[2]], mesh->positions[c[0]]);
		vec_cross(normal, ab, ac);
		vec_normalise(normal);
		for (int k = 0; k < 3; k++) {
			out.indices[3 * t + (uint32_t)k] = (uint16_t)c[k];
			normal_encode(out.vertices[c[k]].normal, normal);
		}
	}
	for (uint32_t v = 0; v < mesh->vertex_count; v++)
		for (int i = 0; i < 3; i++)
			out.vertices[v].position[i] = (int32_t)lrint(
				(mesh->positions[v][i] - lattice.origin_m[i]) / lattice.step_m);
	return out;
}

static void place_in(float out[3], const struct patch_mesh *patch, uint32_t t, float u, float v)
{
	const float share[3] = { 1 - u - v, u, v };

	for (int i = 0; i < 3; i++) {
		out[i] = 0;
		for (uint32_t k = 0; k < 3; k++)
			out[i] +=
				share[k] *
				(float)(lattice.origin_m[i] +
					lattice.step_m * patch->vertices[patch->indices[3 * t + k]]
								 .position[i]);
	}
}

static const float places[][2] = { { 0.05f, 0.05f }, { 0.3f, 0.1f },   { 0.1f, 0.7f },
				   { 0.8f, 0.15f },  { 0.33f, 0.33f }, { 0.5f, 0.45f } };

/* Labels of one patch by parts of a scan. */
static struct label_group label(const struct mesh *scan, const struct label_source_part *parts,
				uint32_t count, const struct patch_mesh *patch, float cell_m)
{
	struct label_source *source;
	struct label_group out;
	struct buffer object;

	CHECK(label_source_create(&source, scan, parts, count) == 0);
	CHECK(label_patch_group(&out, source, &lattice, patch, 1, cell_m) == 0);
	label_source_destroy(source);
	if (out.part_count > 0) { /* keeps every rule of the format */
		buffer_init(&object, 64 << 20);
		CHECK(label_group_encode(&object, &out) == 0);
		buffer_finish(&object);
	}
	return out;
}

/* How many places were looked at, each of which must say what the region does. */
static uint32_t agree(const struct label_group *labels, const struct patch_mesh *patch,
		      const struct region *region, float slack_m)
{
	uint32_t looked = 0;

	for (uint32_t t = 0; t < patch->triangle_count; t++)
		for (size_t k = 0; k < sizeof(places) / sizeof(places[0]); k++) {
			float at[3], away;

			place_in(at, patch, t, places[k][0], places[k][1]);
			away = region_distance(region, at);
			if (fabsf(away) < slack_m)
				continue;
			if ((label_part_at(labels, 0, t, places[k][0], places[k][1]) == 0) !=
			    (away < 0))
				fail_msg("triangle %u at %g %g %g, %g m from the outline", t,
					 (double)at[0], (double)at[1], (double)at[2], (double)away);
			looked++;
		}
	return looked;
}

/* ---- claims */

/* The patch's triangles are eight times as large as the scan's: the outline runs within them. */
static void a_ball_cuts_a_circle_out_of_a_coarse_patch(void **state)
{
	const struct label_source_part part = {
		.id = "ball",
		.region = { .kind = REGION_SPHERE, .centre_m = { 0.1f, 0, 0.3f }, .radius_m = 0.5f }
	};
	struct mesh scan = sheet(64, 0), coarse = sheet(8, 0);
	struct patch_mesh patch = patch_of(&coarse);
	struct label_group labels = label(&scan, &part, 1, &patch, 2.0f / 64);

	(void)state;
	CHECK(labels.part_count == 1 && strcmp(labels.parts[0].id, "ball") == 0);
	/* A disc of radius 0.4. */
	CHECK(fabsf(labels.parts[0].area_m2 - 0.16f * (float)M_PI) < 0.02f);
	CHECK(labels.patches[0].border_count > 8);
	CHECK(agree(&labels, &patch, &part.region, 0.01f) > 600);
	label_group_finish(&labels);
	patch_mesh_finish(&patch);
	toy_free(&scan);
	toy_free(&coarse);
}

static void a_turned_box_keeps_its_corners(void **state)
{
	const struct label_source_part part = { .id = "box",
						.region = { .kind = REGION_BOX,
							    .centre_m = { 0, 0.1f, 0 },
							    .half_m = { 0.6f, 0.25f, 0.2f },
							    .turn_deg = 30 } };
	struct mesh scan = sheet(64, 0), coarse = sheet(6, 0);
	struct patch_mesh patch = patch_of(&coarse);
	struct label_group labels = label(&scan, &part, 1, &patch, 2.0f / 64);

	(void)state;
	CHECK(fabsf(labels.parts[0].area_m2 - 0.6f) < 0.04f);
	CHECK(agree(&labels, &patch, &part.region, 0.02f) > 300);
	label_group_finish(&labels);
	patch_mesh_finish(&patch);
	toy_free(&scan);
	toy_free(&coarse);
}

static void a_list_of_faces_is_those_faces(void **state)
{
	struct mesh scan = sheet(32, 0), coarse = sheet(4, 0);
	struct patch_mesh patch = patch_of(&coarse);
	uint32_t triangles[32 * 8];
	const struct label_source_part part = { .id = "step",
						.triangles = triangles,
						.triangle_count = 32 * 8 };
	struct label_group labels;

	(void)state;
	for (uint32_t t = 0; t < 32 * 8; t++) /* four rows of 32: y below -0.75 */
		triangles[t] = t;
	labels = label(&scan, &part, 1, &patch, 2.0f / 32);
	CHECK(fabsf(labels.parts[0].area_m2 - 0.5f) < 1e-4f);
	for (uint32_t t = 0; t < patch.triangle_count; t++)
		for (size_t k = 0; k < sizeof(places) / sizeof(places[0]); k++) {
			float at[3];

			place_in(at, &patch, t, places[k][0], places[k][1]);
			if (fabsf(at[1] + 0.75f) > 0.02f)
				CHECK((label_part_at(&labels, 0, t, places[k][0], places[k][1]) ==
				       0) == (at[1] < -0.75f));
		}
	label_group_finish(&labels);
	patch_mesh_finish(&patch);
	toy_free(&scan);
	toy_free(&coarse);
}

/* As loose stones of a scan are parts: nothing lies beyond their rims that could be outside. */
static void a_part_that_ends_with_the_surface_is_outlined_all_around(void **state)
{
	struct mesh scan = sheet(32, 0), coarse = sheet(8, 0);
	struct patch_mesh patch = patch_of(&coarse);
	uint32_t triangles[2 * 32 * 32];
	const struct label_source_part part = { .id = "stone",
						.triangles = triangles,
						.triangle_count = 2 * 32 * 32 };
	struct label_group labels;

	(void)state;
	for (uint32_t t = 0; t < 2 * 32 * 32; t++)
		triangles[t] = t;
	labels = label(&scan, &part, 1, &patch, 2.0f / 32);
	for (uint32_t t = 0; t < patch.triangle_count; t++) {
		bool at_rim = false;
		uint32_t first;

		for (uint32_t k = 0; k < 3; k++) {
			const int32_t *at = patch.vertices[patch.indices[3 * t + k]].position;

			at_rim |= at[0] == 1024 || at[0] == 3072 || at[1] == 1024 || at[1] == 3072;
		}
		CHECK((label_borders(&labels.patches[0], t, &first) == 1) == at_rim);
		CHECK(label_part_at(&labels, 0, t, 0.33f, 0.33f) == 0);
	}
	label_group_finish(&labels);
	patch_mesh_finish(&patch);
	toy_free(&scan);
	toy_free(&coarse);
}

/* A wall 4 cm thick, and a patch that is off by more than that: the face that looks up is a part,
 * the one that looks down is not. */
static void the_sides_of_a_thin_wall_are_not_confused(void **state)
{
	struct mesh scan = toy_empty(2 * 33 * 33, 4 * 32 * 32), above, below;
	uint32_t triangles[2 * 32 * 32];
	struct label_source_part part = { .id = "top",
					  .triangles = triangles,
					  .triangle_count = 2 * 32 * 32 };
	struct patch_mesh patch;
	struct label_group labels;

	(void)state;
	add_sheet(&scan, 32, 0.02f, true);
	add_sheet(&scan, 32, -0.02f, false);
	for (uint32_t t = 0; t < 2 * 32 * 32; t++)
		triangles[t] = t;
	above = sheet(4, -0.03f); /* simplified through the wall to its other side */
	patch = patch_of(&above);
	labels = label(&scan, &part, 1, &patch, 2.0f / 32);
	CHECK(labels.part_count == 1);
	for (uint32_t t = 0; t < patch.triangle_count; t++)
		CHECK(label_part_at(&labels, 0, t, 0.33f, 0.33f) == 0);
	label_group_finish(&labels);
	patch_mesh_finish(&patch);
	toy_free(&above);

	below = toy_empty(25, 32);
	add_sheet(&below, 4, 0.03f, false);
	patch = patch_of(&below);
	labels = label(&scan, &part, 1, &patch, 2.0f / 32);
	for (uint32_t t = 0; labels.part_count > 0 && t < patch.triangle_count; t++)
		CHECK(label_part_at(&labels, 0, t, 0.33f, 0.33f) == -1);
	label_group_finish(&labels);
	patch_mesh_finish(&patch);
	toy_free(&below);
	toy_free(&scan);
}

static void the_smaller_of_two_parts_answers(void **state)
{
	const struct label_source_part parts[2] = {
		{ .id = "all", .region = { .kind = REGION_SPHERE, .radius_m = 9 } },
		{ .id = "relief", .region = { .kind = REGION_SPHERE, .radius_m = 0.4f } },
	};
	struct mesh scan = sheet(32, 0), coarse = sheet(4, 0);
	struct patch_mesh patch = patch_of(&coarse);
	struct label_group labels = label(&scan, parts, 2, &patch, 2.0f / 32);
	int relief = label_find(&labels, "relief"), all = label_find(&labels, "all");

	(void)state;
	CHECK(relief >= 0 && all >= 0);
	for (uint32_t t = 0; t < patch.triangle_count; t++) {
		float at[3];

		place_in(at, &patch, t, 0.33f, 0.33f);
		CHECK(label_holds(&labels, 0, t, (uint32_t)all));
		if (fabsf(vec_length(at) - 0.4f) > 0.02f)
			CHECK(label_part_at(&labels, 0, t, 0.33f, 0.33f) ==
			      (vec_length(at) < 0.4f ? relief : all));
	}
	label_group_finish(&labels);
	patch_mesh_finish(&patch);
	toy_free(&scan);
	toy_free(&coarse);
}

static void a_part_that_is_elsewhere_leaves_no_labels(void **state)
{
	const struct label_source_part part = {
		.id = "far",
		.region = { .kind = REGION_SPHERE, .centre_m = { 0, 0, 9 }, .radius_m = 1 }
	};
	struct mesh scan = sheet(8, 0);
	struct patch_mesh patch = patch_of(&scan);
	struct label_group labels = label(&scan, &part, 1, &patch, 0.25f);

	(void)state;
	CHECK(labels.part_count == 0);
	label_group_finish(&labels);
	patch_mesh_finish(&patch);
	toy_free(&scan);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_ball_cuts_a_circle_out_of_a_coarse_patch),
		cmocka_unit_test(a_turned_box_keeps_its_corners),
		cmocka_unit_test(a_list_of_faces_is_those_faces),
		cmocka_unit_test(a_part_that_ends_with_the_surface_is_outlined_all_around),
		cmocka_unit_test(the_sides_of_a_thin_wall_are_not_confused),
		cmocka_unit_test(the_smaller_of_two_parts_answers),
		cmocka_unit_test(a_part_that_is_elsewhere_leaves_no_labels),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
