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

static int compare_vertices(const void *a, const void *b)
{
	return memcmp(a, b, sizeof(struct patch_vertex));
}

static int compare_triangles(const void *a, const void *b)
{
	return memcmp(a, b, 3 * sizeof(struct patch_vertex));
}

/* The triangles as vertices, each from its smallest corner on, sorted. Owned by the caller. */
static struct patch_vertex *sorted_triangles(const struct patch_mesh *mesh)
{
	size_t bytes = 3 * sizeof(struct patch_vertex);
	struct patch_vertex *out = malloc(mesh->triangle_count * bytes);

	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		struct patch_vertex turned[5];

		for (int i = 0; i < 5; i++)
			turned[i] = mesh->vertices[mesh->indices[3 * t + (uint32_t)i % 3]];
		memcpy(&out[3 * t], turned, bytes);
		for (int i = 1; i < 3; i++)
			if (compare_triangles(&turned[i], &out[3 * t]) < 0)
				memcpy(&out[3 * t], &turned[i], bytes);
	}
	qsort(out, mesh->triangle_count, bytes, compare_triangles);
	return out;
}

/* Equal but for the order of triangles and vertices, and the corner at which a triangle begins. */
static void check_equal(const struct patch_mesh *a, const struct patch_mesh *b)
{
	size_t bytes = a->vertex_count * sizeof(*a->vertices);
	struct patch_vertex *first = sorted_triangles(a), *second = sorted_triangles(b);

	CHECK(a->vertex_count == b->vertex_count && a->triangle_count == b->triangle_count);
	CHECK(memcmp(first, second, 3 * a->triangle_count * sizeof(*first)) == 0);
	free(first);
	free(second);
	first = malloc(bytes);
	second = malloc(bytes);
	memcpy(first, a->vertices, bytes);
	memcpy(second, b->vertices, bytes);
	qsort(first, a->vertex_count, sizeof(*first), compare_vertices);
	qsort(second, a->vertex_count, sizeof(*second), compare_vertices);
	CHECK(memcmp(first, second, bytes) == 0);
	free(first);
	free(second);
}

/* Encodes and decodes, and checks that the same patches come back. Returns the bytes they take. */
static size_t round_trip(const struct patch_mesh *patches, uint32_t patch_count)
{
	struct patch_mesh back[GROUP_PATCHES_MAX];
	struct buffer object;
	size_t bytes;
	uint32_t count;

	buffer_init(&object, 16 << 20);
	CHECK(patch_group_encode(&object, patches, patch_count) == 0);
	CHECK(patch_group_decode(back, &count, buffer_bytes(&object)) == 0);
	CHECK(count == patch_count);
	for (uint32_t p = 0; p < count; p++) {
		check_equal(&patches[p], &back[p]);
		patch_mesh_finish(&back[p]);
	}
	bytes = object.size;
	buffer_finish(&object);
	return bytes;
}

static void gives_back_every_bit_of_every_patch(void **state)
{
	struct patch_mesh patches[3] = { sheet(SIDE, 1), sheet(2, 77), sheet(9, 3) };

	(void)state;
	patches[2].vertices[4].normal[0] = -128; /* odd, but it is the caller's */
	CHECK(round_trip(patches, 3) < 16 * (SIDE * SIDE + 4 + 81));
	for (uint32_t p = 0; p < 3; p++)
		patch_mesh_finish(&patches[p]);
}

static void stores_vertices_that_patches_share_once(void **state)
{
	struct patch_mesh patches[3] = { sheet(SIDE, 1), sheet(SIDE, 1), sheet(SIDE, 1) };
	size_t alone = round_trip(patches, 1);

	(void)state;
	CHECK(round_trip(patches, 2) < 3 * alone / 2);
	/* The two halves of a sheet, of which the second has vertices that it does not use. */
	patches[0].triangle_count /= 2;
	patches[1].triangle_count -= patches[0].triangle_count;
	memmove(patches[1].indices, patches[1].indices + 3 * (size_t)patches[0].triangle_count,
		3 * (size_t)patches[1].triangle_count * sizeof(*patches[1].indices));
	round_trip(patches, 2);
	round_trip(patches, 3);
	for (uint32_t p = 0; p < 3; p++)
		patch_mesh_finish(&patches[p]);
}

/* Two vertices of one patch stay two, even if they are equal. */
static void keeps_equal_vertices_apart(void **state)
{
	struct patch_mesh patches[2] = { sheet(5, 1), sheet(5, 1) };

	(void)state;
	for (uint32_t v = 1; v < 25; v++)
		patches[0].vertices[v] = patches[1].vertices[v] = patches[0].vertices[0];
	round_trip(patches, 2);
	patch_mesh_finish(&patches[0]);
	patch_mesh_finish(&patches[1]);
}

static void gives_back_what_is_no_surface(void **state)
{
	static const uint16_t cases[][3 * 6] = {
		/* one edge of six triangles, all in one direction */
		{ 0, 1, 2, 0, 1, 3, 0, 1, 4, 0, 1, 5, 0, 1, 6, 0, 1, 7 },
		/* the same triangle again and again, also from behind */
		{ 0, 1, 2, 1, 2, 0, 0, 1, 2, 2, 1, 0, 0, 2, 1, 0, 1, 2 },
		/* triangles without area */
		{ 0, 0, 0, 0, 0, 1, 1, 0, 0, 2, 3, 2, 3, 2, 3, 7, 7, 7 },
		/* a closed solid, then two triangles that touch it in a vertex */
		{ 0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3, 3, 4, 5, 3, 6, 7 },
		/* a band, the second half of it turned over */
		{ 0, 1, 2, 2, 1, 3, 2, 3, 4, 4, 3, 5, 5, 4, 1, 5, 1, 0 },
	};
	struct patch_mesh mesh = sheet(4, 5);

	(void)state;
	mesh.triangle_count = 6;
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		memcpy(mesh.indices, cases[i], sizeof(cases[i]));
		round_trip(&mesh, 1);
	}
	patch_mesh_finish(&mesh);
}

/* Triangles between any vertices of several patches, which fit no border. */
static void gives_back_triangles_at_random(void **state)
{
	struct patch_mesh patches[4] = { sheet(8, 1), sheet(8, 1), sheet(8, 1), sheet(8, 2) };
	uint32_t random = 1;

	(void)state;
	for (int round = 0; round < 100; round++) {
		for (int p = 0; p < 4; p++)
			for (uint32_t i = 0; i < 3 * patches[p].triangle_count; i++) {
				random = random * 1664525 + 1013904223;
				patches[p].indices[i] =
					(uint16_t)((random >> 16) % (uint32_t)(4 + round / 2));
			}
		round_trip(patches, 4);
	}
	for (int p = 0; p < 4; p++)
		patch_mesh_finish(&patches[p]);
}

static void gives_back_the_smallest_and_the_largest(void **state)
{
	struct patch_mesh patches[GROUP_PATCHES_MAX],
		large = { PATCH_VERTICES_MAX, PATCH_TRIANGLES_MAX, NULL, NULL };

	(void)state;
	for (uint32_t p = 0; p < GROUP_PATCHES_MAX; p++) {
		patches[p] = sheet(3, p);
		patches[p].triangle_count = 1;
	}
	round_trip(patches, 1);
	round_trip(patches, GROUP_PATCHES_MAX);
	large.vertices = calloc(large.vertex_count, sizeof(*large.vertices));
	large.indices = calloc(3 * (size_t)large.triangle_count, sizeof(*large.indices));
	for (uint32_t v = 0; v < large.vertex_count; v++) {
		large.indices[v] = (uint16_t)v;
		large.vertices[v].position[v % 3] = (int32_t)(v % 2 ? 65535 - v : v);
	}
	round_trip(&large, 1);
	patch_mesh_finish(&large);
	for (uint32_t p = 0; p < GROUP_PATCHES_MAX; p++)
		patch_mesh_finish(&patches[p]);
}

/* What a release rounds to: fewer digits, fewer bytes, and still every bit comes back. */
static void tells_round_numbers_in_fewer_bytes(void **state)
{
	struct patch_mesh mesh = sheet(SIDE, 1);
	size_t exact_bytes;

	(void)state;
	for (uint32_t v = 0; v < mesh.vertex_count; v++) { /* nothing that could be foreseen */
		for (uint32_t i = 0; i < 4; i++)
			mesh.vertices[v].colour[i] =
				(uint8_t)((4 * v + i + 1) * 2654435761u >> 11 & 0xff);
		mesh.vertices[v].position[2] = (int32_t)(v * 2654435761u >> 16);
	}
	exact_bytes = round_trip(&mesh, 1);
	for (uint32_t v = 0; v < mesh.vertex_count; v++) {
		struct patch_vertex *vertex = &mesh.vertices[v];

		for (int i = 0; i < 3; i++)
			vertex->position[i] &= 0xfff8;
		for (int i = 0; i < 2; i++)
			vertex->normal[i] = patch_round_normal(vertex->normal[i], 6);
		for (int i = 0; i < 3; i++)
			vertex->colour[i] =
				(uint8_t)((vertex->colour[i] & 0xfc) | vertex->colour[i] >> 6);
		vertex->colour[3] = (uint8_t)((vertex->colour[3] & 0xf0) | vertex->colour[3] >> 4);
	}
	CHECK(round_trip(&mesh, 1) < 8 * exact_bytes / 10);
	patch_mesh_finish(&mesh);
}

static void keeps_vertices_that_no_triangle_names(void **state)
{
	struct patch_mesh patches[3] = { sheet(4, 5), sheet(4, 5), sheet(3, 5) };

	(void)state;
	for (int p = 0; p < 2; p++) {
		patches[p].triangle_count = 2;
		patches[p].indices[1] = patches[p].indices[0]; /* and triangles without area */
	}
	round_trip(patches, 3);
	for (int p = 0; p < 3; p++)
		patch_mesh_finish(&patches[p]);
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

/* Plain bits may differ and give another mesh; everything else is noticed at the latest where the
 * last state is not the encoder's first. */
static void survives_every_flipped_bit(void **state)
{
	struct patch_mesh patches[2] = { sheet(5, 1), sheet(4, 2) };
	struct buffer object;
	size_t accepted = 0;

	(void)state;
	buffer_init(&object, 1 << 20);
	CHECK(patch_group_encode(&object, patches, 2) == 0);
	for (size_t bit = 0; bit < 8 * object.size; bit++) {
		object.data[bit / 8] ^= (uint8_t)(1 << bit % 8);
		int rc = decode_exact(object.data, object.size);

		CHECK(rc == -EBADMSG || (rc == 0 && bit / 8 >= 7));
		accepted += rc == 0;
		object.data[bit / 8] ^= (uint8_t)(1 << bit % 8);
	}
	CHECK(accepted < 8 * object.size / 2);
	buffer_finish(&object);
	patch_mesh_finish(&patches[0]);
	patch_mesh_finish(&patches[1]);
}

static void survives_bytes_at_random(void **state)
{
	struct patch_mesh patches[3] = { sheet(9, 1), sheet(9, 1), sheet(4, 2) };
	uint32_t random = 7;
	struct buffer object;

	(void)state;
	patches[0].triangle_count = 60;
	buffer_init(&object, 1 << 20);
	CHECK(patch_group_encode(&object, patches, 3) == 0);
	for (int round = 0; round < 3000; round++) {
		uint8_t *copy = malloc(object.size);

		memcpy(copy, object.data, object.size);
		for (int i = 0; i <= round % 8; i++) {
			random = random * 1664525 + 1013904223;
			/* behind magic and version */
			copy[5 + (random >> 8) % (object.size - 5)] = (uint8_t)(random >> 24);
		}
		CHECK(decode_exact(copy, object.size) <= 0);
		free(copy);
	}
	buffer_finish(&object);
	for (int p = 0; p < 3; p++)
		patch_mesh_finish(&patches[p]);
}

/* Rounding moves by half a step at most, does nothing twice, and keeps what flat walls have. */
static void rounds_components_of_normals(void **state)
{
	(void)state;
	for (int bits = 4; bits <= 8; bits++) {
		double step = 127.0 / ((1 << (bits - 1)) - 1);

		for (int value = -127; value <= 127; value++) {
			int8_t rounded = patch_round_normal((int8_t)value, bits);

			CHECK(abs(rounded - value) <= step / 2 + 0.5);
			CHECK(patch_round_normal(rounded, bits) == rounded);
			CHECK(patch_round_normal((int8_t)-value, bits) == -rounded);
		}
		CHECK(patch_round_normal(127, bits) == 127 && patch_round_normal(0, bits) == 0);
	}
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

enum { BASE_BYTES = 13 };

static void places_of_a_large_site_come_back_and_cost_thirteen_bytes_a_group(void **state)
{
	static const int32_t far[3] = { 12345678, LATTICE_PLACES_MAX - 65536, 70000 };
	static const int32_t nowhere[3] = { 0, 0, 0 };
	struct patch_mesh patches[2] = { sheet(SIDE, 1), sheet(9, 3) };
	const size_t small = round_trip(patches, 2);

	(void)state;
	for (int p = 0; p < 2; p++)
		place(&patches[p], far, 0);
	/* The first vertex is predicted at the base, so the streams may differ by a few bytes. */
	CHECK(round_trip(patches, 2) <= small + BASE_BYTES + 16);
	patch_mesh_finish(&patches[0]);
	patches[0] = sheet(SIDE, 1);
	/* One patch near the origin and one far away: a wide group. */
	CHECK(round_trip(patches, 2) > 0);
	patch_mesh_finish(&patches[1]);
	place(&patches[0], nowhere, 8);
	CHECK(round_trip(patches, 1) > 0);
	patch_mesh_finish(&patches[0]);
}

/* The sum of their normals does not fit into 64 bits. */
static void gives_back_thousands_of_large_triangles_at_a_vertex(void **state)
{
	const int32_t far = LATTICE_PLACES_MAX - 1;
	struct patch_vertex vertices[3] = { { .position = { 0, 0, 0 } },
					    { .position = { far, 0, 0 } },
					    { .position = { 0, far, 0 } } };
	uint16_t indices[3 * PATCH_TRIANGLES_MAX];
	struct patch_mesh patches[9];

	(void)state;
	for (uint32_t i = 0; i < ARRAY_COUNT(indices); i++)
		indices[i] = (uint16_t)(i % 3);
	for (uint32_t p = 0; p < ARRAY_COUNT(patches); p++)
		patches[p] = (struct patch_mesh){ .vertices = vertices,
						  .indices = indices,
						  .vertex_count = 3,
						  .triangle_count = PATCH_TRIANGLES_MAX };
	round_trip(patches, ARRAY_COUNT(patches));
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
		CHECK(patch_group_encode(&object, &mesh, 1) == -EINVAL);
		mesh.vertices[7].position[i % 3] = 0;
	}
	patch_mesh_finish(&mesh);
	buffer_finish(&object);
}

/* The base stands behind magic, version, flags, number of patches and precision. */
enum { FLAGS_AT = 5, BASE_AT = 11 };

static void refuses_a_base_that_leads_out_of_the_lattice(void **state)
{
	static const int32_t base[3] = { 100000, 100000, 100000 };
	struct patch_mesh mesh = sheet(SIDE, 1), back[GROUP_PATCHES_MAX];
	struct buffer object;
	uint32_t count;

	(void)state;
	place(&mesh, base, 0);
	buffer_init(&object, 64 << 20);
	CHECK(patch_group_encode(&object, &mesh, 1) == 0);
	CHECK(object.data[FLAGS_AT] == 1 && object.data[BASE_AT] == 2);
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
		cmocka_unit_test(stores_vertices_that_patches_share_once),
		cmocka_unit_test(keeps_equal_vertices_apart),
		cmocka_unit_test(gives_back_what_is_no_surface),
		cmocka_unit_test(gives_back_triangles_at_random),
		cmocka_unit_test(gives_back_the_smallest_and_the_largest),
		cmocka_unit_test(tells_round_numbers_in_fewer_bytes),
		cmocka_unit_test(keeps_vertices_that_no_triangle_names),
		cmocka_unit_test(refuses_to_encode_what_is_no_patch),
		cmocka_unit_test(refuses_every_truncation_and_anything_behind),
		cmocka_unit_test(survives_every_flipped_bit),
		cmocka_unit_test(survives_bytes_at_random),
		cmocka_unit_test(places_of_a_large_site_come_back_and_cost_thirteen_bytes_a_group),
		cmocka_unit_test(gives_back_thousands_of_large_triangles_at_a_vertex),
		cmocka_unit_test(refuses_places_that_are_none),
		cmocka_unit_test(refuses_a_base_that_leads_out_of_the_lattice),
		cmocka_unit_test(rounds_components_of_normals),
		cmocka_unit_test(brings_normals_back_within_a_degree),
		cmocka_unit_test(decodes_a_unit_vector_from_any_two_bytes),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
