#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/patch_bvh.h"
#include "geometry/vec.h"
#include "tests/check.h"

enum { SIDE = 30 }; /* vertices a side of a bumpy square */

static const struct lattice lattice = { { -10, -10, -10 }, 0.001, 0 };

static void make_bumps(struct patch_mesh *mesh)
{
	memset(mesh, 0, sizeof(*mesh));
	mesh->vertices = calloc(SIDE * SIDE, sizeof(*mesh->vertices));
	mesh->indices = calloc(6 * SIDE * SIDE, sizeof(*mesh->indices));
	for (int y = 0; y < SIDE; y++) {
		for (int x = 0; x < SIDE; x++) {
			float z = 10 + 0.8f * sinf((float)x) * cosf((float)y * 0.7f);
			int32_t *at = mesh->vertices[mesh->vertex_count++].position;
			at[0] = 5000 + 300 * x;
			at[1] = 5000 + 300 * y;
			at[2] = (int32_t)(1000 * z);
		}
	}
	for (int y = 0; y + 1 < SIDE; y++) {
		for (int x = 0; x + 1 < SIDE; x++) {
			int a = y * SIDE + x,
			    corner[6] = { a, a + 1, a + SIDE + 1, a, a + SIDE + 1, a + SIDE };
			for (int k = 0; k < 6; k++)
				mesh->indices[3 * mesh->triangle_count + (uint32_t)k] =
					(uint16_t)corner[k];
			mesh->triangle_count += 2;
		}
	}
}

static float uniform(uint32_t *seed)
{
	*seed = *seed * 1664525u + 1013904223u;
	return (float)(*seed >> 8) / 16777216.0f;
}

/* The place on the triangle, by its corners as the mesh came, is the one along the ray. */
static bool is_where_it_says(const struct patch_bvh *bvh, const float from[3],
			     const float direction[3], float distance,
			     const struct patch_bvh_hit *hit, const uint16_t *came)
{
	const uint16_t *corner = &came[3 * bvh->order[hit->triangle]];
	const float share[3] = { 1 - hit->u - hit->v, hit->u, hit->v };
	float on_ray[3], on_triangle[3] = { 0 };
	vec_add_scaled(on_ray, from, distance, direction);
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 3; i++)
			on_triangle[i] +=
				share[k] * (float)(lattice.origin_m[i] +
						   lattice.step_m * bvh->positions[corner[k]][i]);
	return vec_distance(on_ray, on_triangle) < 1e-3f;
}

static void a_ray_meets_what_every_triangle_tried_alone_says(void **state)
{
	(void)state;
	struct patch_mesh mesh;
	struct patch_bvh bvh;
	uint32_t seed = 1, hits = 0;
	make_bumps(&mesh);
	uint16_t *came = malloc(3 * mesh.triangle_count * sizeof(*came));
	memcpy(came, mesh.indices, 3 * mesh.triangle_count * sizeof(*came));
	CHECK(patch_bvh_init(&bvh, &mesh, &lattice) == 0);
	for (int i = 0; i < 2000; i++) {
		float from[3], direction[3];
		for (int k = 0; k < 3; k++) {
			from[k] = 12 * uniform(&seed) - 6;
			direction[k] = 2 * uniform(&seed) - 1;
		}
		vec_normalise(direction);
		float found = INFINITY, nearest = INFINITY;
		struct patch_bvh_hit where;
		bool hit = patch_bvh_ray(&bvh, from, direction, 0, &found, &where);
		/* One leaf of everything: the same test without the tree. */
		struct patch_bvh flat = bvh;
		struct patch_bvh_node all = bvh.nodes[0];
		all.right = 0;
		flat.nodes = &all;
		flat.node_count = 1;
		CHECK(patch_bvh_ray(&flat, from, direction, 0, &nearest, NULL) == hit);
		CHECK(found == nearest);
		hits += hit;
		if (hit)
			CHECK(is_where_it_says(&bvh, from, direction, found, &where, came));
	}
	CHECK(hits > 100 && hits < 1900);
	free(came);
	patch_bvh_finish(&bvh);
	patch_mesh_finish(&mesh);
}

static void pieces_hold_every_triangle_once(void **state)
{
	(void)state;
	struct patch_mesh mesh;
	struct patch_bvh bvh;
	make_bumps(&mesh);
	CHECK(patch_bvh_init(&bvh, &mesh, &lattice) == 0);
	uint32_t next = 0;
	for (uint32_t i = 0; i < bvh.piece_count; i++) {
		const struct piece *piece = &bvh.pieces[i];
		CHECK(piece->first_triangle == next && piece->triangle_count > 0);
		CHECK(piece->triangle_count <= PIECE_TRIANGLES_MAX);
		for (int k = 0; k < PIECE_PROBES; k++)
			CHECK(vec_distance(patch_bvh_probe(&bvh, piece, k).at_m, piece->centre_m) <=
			      piece->radius_m * 1.001f);
		next += piece->triangle_count;
	}
	CHECK(next == mesh.triangle_count);
	patch_bvh_finish(&bvh);
	patch_mesh_finish(&mesh);
}

static void an_empty_patch_is_met_by_nothing(void **state)
{
	(void)state;
	struct patch_mesh mesh = { 0 };
	struct patch_bvh bvh;
	const float from[3] = { 0 }, up[3] = { 0, 0, 1 };
	float distance = INFINITY;
	CHECK(patch_bvh_init(&bvh, &mesh, &lattice) == 0);
	CHECK(!patch_bvh_ray(&bvh, from, up, 0, &distance, NULL));
	patch_bvh_finish(&bvh);
}

static void triangles_in_one_place_do_not_hang_the_split(void **state)
{
	(void)state;
	struct patch_mesh mesh;
	struct patch_bvh bvh;
	make_bumps(&mesh);
	for (uint32_t i = 0; i < mesh.vertex_count; i++)
		memset(mesh.vertices[i].position, 0, sizeof(mesh.vertices[i].position));
	CHECK(patch_bvh_init(&bvh, &mesh, &lattice) == 0);
	CHECK(bvh.piece_count >= 1);
	patch_bvh_finish(&bvh);
	patch_mesh_finish(&mesh);
}

/* The same surface at the far corner of a large site, and as a wide patch there: rays hit where
 * they hit near the origin. */
static void far_and_wide_patches_are_hit_at_the_same_places(void **state)
{
	(void)state;
	static const int32_t far[3] = { 900000, 16000000, 500000 };
	for (int stretch = 0; stretch < 7; stretch += 3) {
		struct lattice fine = { .step_m = 0.001 / (1 << stretch), .fine_bits = 8 };
		struct patch_mesh near_mesh, mesh;
		struct patch_bvh near, bvh;
		uint32_t seed = 3, hits = 0;
		make_bumps(&near_mesh);
		make_bumps(&mesh);
		for (uint32_t v = 0; v < mesh.vertex_count; v++)
			for (int i = 0; i < 3; i++)
				mesh.vertices[v].position[i] =
					far[i] + (mesh.vertices[v].position[i] << stretch);
		for (int i = 0; i < 3; i++)
			fine.origin_m[i] = lattice.origin_m[i] - fine.step_m * far[i];
		CHECK(patch_bvh_init(&near, &near_mesh, &lattice) == 0);
		CHECK(patch_bvh_init(&bvh, &mesh, &fine) == 0);
		CHECK((bvh.wide != NULL) == (stretch > 2) && !near.wide && near.base[0] == 0);
		CHECK(bvh.base[1] >= far[1] && bvh.vertex_count == near.vertex_count);
		for (int i = 0; i < 1000; i++) {
			float from[3], direction[3], was = 100, is = 100;
			for (int k = 0; k < 3; k++) {
				from[k] = 12 * uniform(&seed) - 6;
				direction[k] = uniform(&seed) - 0.5f;
			}
			from[2] = 5;
			direction[2] = -1;
			vec_normalise(direction);
			bool hit = patch_bvh_ray(&near, from, direction, 0, &was, NULL);
			CHECK(patch_bvh_ray(&bvh, from, direction, 0, &is, NULL) == hit);
			CHECK(patch_bvh_blocks(&bvh, from, direction, 100) == hit);
			CHECK(fabsf(is - was) < 1e-4f);
			hits += hit;
		}
		CHECK(hits > 200);
		for (uint32_t p = 0; p < bvh.piece_count; p++)
			for (int k = 0; k < 3; k++)
				CHECK(fabsf(bvh.pieces[p].centre_m[k]) < 10);
		patch_bvh_finish(&near);
		patch_bvh_finish(&bvh);
		patch_mesh_finish(&near_mesh);
		patch_mesh_finish(&mesh);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_ray_meets_what_every_triangle_tried_alone_says),
		cmocka_unit_test(pieces_hold_every_triangle_once),
		cmocka_unit_test(an_empty_patch_is_met_by_nothing),
		cmocka_unit_test(far_and_wide_patches_are_hit_at_the_same_places),
		cmocka_unit_test(triangles_in_one_place_do_not_hang_the_split),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
