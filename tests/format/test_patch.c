#include "format/patch.h"
#include "format/root_page.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "format/normal.h"
#include "tests/check.h"

enum { SIDE = 24 };

/* A bumpy sheet with colours, its triangles row by row; vertex 0 last so that the order in which
 * triangles name vertices is not the order of the vertices. */
static struct patch_mesh sheet(uint32_t side, uint32_t seed)
{
	struct patch_mesh mesh = { .vertex_count = side * side,
				   .triangle_count = 2 * (side - 1) * (side - 1) };
	uint16_t *index;

	mesh.vertices = calloc(mesh.vertex_count, sizeof(*mesh.vertices));
	mesh.indices = calloc(3 * mesh.triangle_count, sizeof(*mesh.indices));
	for (uint32_t v = 0; v < mesh.vertex_count; v++) {
		struct patch_vertex *vertex = &mesh.vertices[mesh.vertex_count - 1 - v];
		float normal[3] = { sinf((float)(v + seed)), 0.3f, 1.0f };

		vertex->position[0] = (int32_t)(500 * (v % side));
		vertex->position[1] = (int32_t)(65535 - 400 * (v / side));
		vertex->position[2] = (int32_t)((v * 7919 + seed) % 97);
		normal_encode(vertex->normal, normal);
		for (uint32_t i = 0; i < 4; i++)
			vertex->colour[i] = (uint8_t)(v * (i + 3) + seed);
	}
	index = mesh.indices;
	for (uint32_t y = 0; y + 1 < side; y++)
		for (uint32_t x = 0; x + 1 < side; x++) {
			uint16_t at = (uint16_t)(mesh.vertex_count - 1 - (y * side + x));
			uint16_t quad[6] = { at,
					     (uint16_t)(at - 1),
					     (uint16_t)(at - side),
					     (uint16_t)(at - side),
					     (uint16_t)(at - 1),
					     (uint16_t)(at - side - 1) };

			memcpy(index, quad, sizeof(quad));
			index += 6;
		}
	return mesh;
}

/* Equal but for the corner at which a triangle begins. */
static bool same_triangle(const uint16_t *a, const uint16_t *b)
{
	for (int turn = 0; turn < 3; turn++)
		if (a[0] == b[turn] && a[1] == b[(turn + 1) % 3] && a[2] == b[(turn + 2) % 3])
			return true;
	return false;
}

static void check_equal(const struct patch_mesh *a, const struct patch_mesh *b)
{
	CHECK(a->vertex_count == b->vertex_count && a->triangle_count == b->triangle_count);
	CHECK(memcmp(a->vertices, b->vertices, a->vertex_count * sizeof(*a->vertices)) == 0);
	for (uint32_t t = 0; t < a->triangle_count; t++)
		CHECK(same_triangle(a->indices + 3 * (size_t)t, b->indices + 3 * (size_t)t));
}

static void gives_back_every_bit_of_every_patch(void **state)
{
	struct patch_mesh patches[3] = { sheet(SIDE, 1), sheet(2, 77), sheet(9, 3) };
	struct patch_mesh back[GROUP_PATCHES_MAX];
	struct buffer object;
	uint32_t count;

	(void)state;
	patches[2].vertices[4].normal[0] = -128; /* odd, but it is the caller's */
	buffer_init(&object, 1 << 20);
	CHECK(patch_group_encode(&object, patches, 3) == 0);
	CHECK(object.size < 24 * (SIDE * SIDE + 4 + 81));
	CHECK(patch_group_decode(back, &count, buffer_bytes(&object)) == 0);
	CHECK(count == 3);
	for (uint32_t p = 0; p < 3; p++) {
		check_equal(&patches[p], &back[p]);
		patch_mesh_finish(&patches[p]);
		patch_mesh_finish(&back[p]);
	}
	buffer_finish(&object);
}

/* What a release rounds to: fewer digits, fewer bytes, and still every bit comes back. */
static void tells_round_numbers_in_fewer_bytes(void **state)
{
	struct patch_mesh mesh = sheet(SIDE, 1), back[GROUP_PATCHES_MAX];
	struct buffer object;
	size_t exact_bytes;
	uint32_t count;

	(void)state;
	for (uint32_t v = 0; v < mesh.vertex_count; v++) /* nothing that zstd could foresee */
		for (uint32_t i = 0; i < 4; i++)
			mesh.vertices[v].colour[i] =
				(uint8_t)((4 * v + i + 1) * 2654435761u >> 11 & 0xff);
	buffer_init(&object, 1 << 20);
	CHECK(patch_group_encode(&object, &mesh, 1) == 0);
	exact_bytes = object.size;
	for (uint32_t v = 0; v < mesh.vertex_count; v++) {
		struct patch_vertex *vertex = &mesh.vertices[v];

		vertex->normal[0] = (int8_t)(vertex->normal[0] / 4 * 4);
		vertex->normal[1] = (int8_t)(vertex->normal[1] / 4 * 4);
		for (int i = 0; i < 3; i++)
			vertex->colour[i] =
				(uint8_t)((vertex->colour[i] & 0xfc) | vertex->colour[i] >> 6);
		vertex->colour[3] = (uint8_t)((vertex->colour[3] & 0xf0) | vertex->colour[3] >> 4);
	}
	buffer_clear(&object);
	CHECK(patch_group_encode(&object, &mesh, 1) == 0);
	CHECK(object.size < 9 * exact_bytes / 10);
	CHECK(patch_group_decode(back, &count, buffer_bytes(&object)) == 0);
	CHECK(count == 1);
	check_equal(&mesh, &back[0]);
	patch_mesh_finish(&back[0]);
	patch_mesh_finish(&mesh);
	buffer_finish(&object);
}

static void keeps_vertices_that_no_triangle_names(void **state)
{
	struct patch_mesh mesh = sheet(4, 5), back[GROUP_PATCHES_MAX];
	struct buffer object;
	uint32_t count;

	(void)state;
	mesh.triangle_count = 2;
	mesh.indices[1] = mesh.indices[0]; /* and triangles without area */
	buffer_init(&object, 1 << 20);
	CHECK(patch_group_encode(&object, &mesh, 1) == 0);
	CHECK(patch_group_decode(back, &count, buffer_bytes(&object)) == 0);
	check_equal(&mesh, &back[0]);
	patch_mesh_finish(&back[0]);
	patch_mesh_finish(&mesh);
	buffer_finish(&object);
}

static void refuses_to_encode_what_is_no_patch(void **state)
{
	struct patch_mesh mesh = sheet(4, 5);
	struct buffer object;

	(void)state;
	buffer_init(&object, 1 << 20);
	CHECK(patch_group_encode(&object, &mesh, 0) == -EINVAL);
	CHECK(patch_group_encode(&object, &mesh, GROUP_PATCHES_MAX + 1) == -EINVAL);
	mesh.indices[5] = (uint16_t)mesh.vertex_count;
	CHECK(patch_group_encode(&object, &mesh, 1) == -EINVAL);
	mesh.triangle_count = 0;
	CHECK(patch_group_encode(&object, &mesh, 1) == -EINVAL);
	patch_mesh_finish(&mesh);
	buffer_finish(&object);
}

static int decode_exact(const uint8_t *data, size_t size)
{
	struct patch_mesh back[GROUP_PATCHES_MAX];
	uint8_t *exact = malloc(size ? size : 1); /* no slack for the sanitizer */
	uint32_t count;
	int rc;

	memcpy(exact, data, size);
	rc = patch_group_decode(back, &count, (struct bytes){ exact, size });
	for (uint32_t p = 0; rc == 0 && p < count; p++)
		patch_mesh_finish(&back[p]);
	if (rc < 0)
		CHECK(count == 0 && !back[0].vertices && !back[0].indices);
	free(exact);
	return rc;
}

static void refuses_every_truncation_and_anything_behind(void **state)
{
	struct patch_mesh patches[2] = { sheet(5, 1), sheet(3, 2) };
	struct buffer object;

	(void)state;
	buffer_init(&object, 1 << 20);
	CHECK(patch_group_encode(&object, patches, 2) == 0);
	for (size_t n = 0; n < object.size; n++)
		CHECK(decode_exact(object.data, n) == -EBADMSG);
	CHECK(decode_exact(object.data, object.size) == 0);
	buffer_put_u8(&object, 0);
	CHECK(decode_exact(object.data, object.size) == -EBADMSG);
	buffer_finish(&object);
	patch_mesh_finish(&patches[0]);
	patch_mesh_finish(&patches[1]);
}

static void survives_every_flipped_bit_of_the_header(void **state)
{
	struct patch_mesh mesh = sheet(5, 1);
	struct buffer object;

	(void)state;
	buffer_init(&object, 1 << 20);
	CHECK(patch_group_encode(&object, &mesh, 1) == 0);
	for (size_t bit = 0; bit < 8 * 15; bit++) {
		object.data[bit / 8] ^= (uint8_t)(1 << bit % 8);
		int rc = decode_exact(object.data, object.size);

		/* Another precision within its limits is another group. */
		CHECK(rc == -EBADMSG || (rc == 0 && bit / 8 >= 6 && bit / 8 < 9));
		object.data[bit / 8] ^= (uint8_t)(1 << bit % 8);
	}
	buffer_finish(&object);
	patch_mesh_finish(&mesh);
}

static void brings_normals_back_within_a_degree(void **state)
{
	(void)state;
	for (int i = 0; i < 5000; i++) {
		float z = 1.0f - 2.0f * (float)i / 4999.0f, turn = 2.39996f * (float)i;
		float radius = sqrtf(fmaxf(0.0f, 1.0f - z * z));
		float in[3] = { radius * cosf(turn), radius * sinf(turn), z }, out[3];
		int8_t packed[2];

		normal_encode(packed, in);
		normal_decode(out, packed);
		CHECK(fabsf(out[0] * out[0] + out[1] * out[1] + out[2] * out[2] - 1.0f) < 1e-5f);
		CHECK(in[0] * out[0] + in[1] * out[1] + in[2] * out[2] > cosf(0.0175f));
	}
}

static void decodes_a_unit_vector_from_any_two_bytes(void **state)
{
	(void)state;
	for (int i = 0; i < 65536; i++) {
		int8_t packed[2] = { (int8_t)(i & 255), (int8_t)(i >> 8) };
		float out[3];

		normal_decode(out, packed);
		CHECK(fabsf(out[0] * out[0] + out[1] * out[1] + out[2] * out[2] - 1.0f) < 1e-5f);
	}
}

/* Moves a patch, and stretches it by 2 to a power. */
static void place(struct patch_mesh *mesh, const int32_t base[3], int stretch)
{
	for (uint32_t v = 0; v < mesh->vertex_count; v++)
		for (int i = 0; i < 3; i++)
			mesh->vertices[v].position[i] =
				base[i] + (mesh->vertices[v].position[i] << stretch);
}

static size_t check_comes_back(const struct patch_mesh *patches, uint32_t count)
{
	struct patch_mesh back[GROUP_PATCHES_MAX];
	struct buffer object;
	uint32_t back_count;
	size_t size;

	buffer_init(&object, 64 << 20);
	CHECK(patch_group_encode(&object, patches, count, PATCH_SMALL) == 0);
	CHECK(patch_group_decode(back, &back_count, buffer_bytes(&object)) == 0);
	CHECK(back_count == count);
	for (uint32_t p = 0; p < count; p++) {
		check_equal(&patches[p], &back[p]);
		patch_mesh_finish(&back[p]);
	}
	size = object.size;
	buffer_finish(&object);
	return size;
}

enum { BASE_BYTES = 13 };

static void places_of_a_large_site_come_back_and_cost_thirteen_bytes_a_group(void **state)
{
	static const int32_t far[3] = { 12345678, LATTICE_PLACES_MAX - 65536, 70000 };
	static const int32_t nowhere[3] = { 0, 0, 0 };
	struct patch_mesh patches[2] = { sheet(SIDE, 1), sheet(9, 3) };
	const size_t small = check_comes_back(patches, 2);

	(void)state;
	for (int p = 0; p < 2; p++)
		place(&patches[p], far, 0);
	/* The first vertex is predicted at the base, so the streams may differ by a few bytes. */
	CHECK(check_comes_back(patches, 2) <= small + BASE_BYTES + 16);
	patch_mesh_finish(&patches[0]);
	patches[0] = sheet(SIDE, 1);
	/* One patch near the origin and one far away: a wide group. */
	CHECK(check_comes_back(patches, 2) > 0);
	patch_mesh_finish(&patches[1]);
	place(&patches[0], nowhere, 8);
	CHECK(check_comes_back(patches, 1) > 0);
	patch_mesh_finish(&patches[0]);
}

static void refuses_places_that_are_none(void **state)
{
	static const int32_t places[] = { -1, LATTICE_PLACES_MAX, INT32_MAX, INT32_MIN };
	struct patch_mesh mesh = sheet(9, 3);
	struct buffer object;

	(void)state;
	buffer_init(&object, 64 << 20);
	for (size_t i = 0; i < sizeof(places) / sizeof(*places); i++) {
		mesh.vertices[7].position[i % 3] = places[i];
		CHECK(patch_group_encode(&object, &mesh, 1, PATCH_FAST) == -EINVAL);
		mesh.vertices[7].position[i % 3] = 0;
	}
	patch_mesh_finish(&mesh);
	buffer_finish(&object);
}

/* The base stands behind magic, version, number of patches and precision. */
enum { BASE_AT = 9 };

static void refuses_a_base_that_leads_out_of_the_lattice(void **state)
{
	static const int32_t base[3] = { 100000, 100000, 100000 };
	struct patch_mesh mesh = sheet(SIDE, 1), back[GROUP_PATCHES_MAX];
	struct buffer object;
	uint32_t count;

	(void)state;
	place(&mesh, base, 0);
	buffer_init(&object, 64 << 20);
	CHECK(patch_group_encode(&object, &mesh, 1, PATCH_SMALL) == 0);
	CHECK((object.data[5] & 0x80) != 0 && object.data[BASE_AT] == 2);
	/* 65535 steps up from the highest place that a base may have. */
	memset(object.data + BASE_AT + 5, 0xff, 3);
	CHECK(patch_group_decode(back, &count, buffer_bytes(&object)) == -EBADMSG);
	object.data[BASE_AT + 8] = 1;
	CHECK(patch_group_decode(back, &count, buffer_bytes(&object)) == -EBADMSG);
	object.data[BASE_AT] = 4;
	CHECK(patch_group_decode(back, &count, buffer_bytes(&object)) == -EBADMSG);
	buffer_finish(&object);
	patch_mesh_finish(&mesh);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(gives_back_every_bit_of_every_patch),
		cmocka_unit_test(tells_round_numbers_in_fewer_bytes),
		cmocka_unit_test(keeps_vertices_that_no_triangle_names),
		cmocka_unit_test(refuses_to_encode_what_is_no_patch),
		cmocka_unit_test(refuses_every_truncation_and_anything_behind),
		cmocka_unit_test(survives_every_flipped_bit_of_the_header),
		cmocka_unit_test(places_of_a_large_site_come_back_and_cost_thirteen_bytes_a_group),
		cmocka_unit_test(refuses_places_that_are_none),
		cmocka_unit_test(refuses_a_base_that_leads_out_of_the_lattice),
		cmocka_unit_test(brings_normals_back_within_a_degree),
		cmocka_unit_test(decodes_a_unit_vector_from_any_two_bytes),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
