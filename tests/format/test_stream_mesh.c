#include "format/stream_mesh.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "tests/check.h"

enum { RECORDS = 4000, VERTICES = 6000, TRIANGLES = 12000 };

static uint32_t random_next(uint32_t *seed)
{
	*seed ^= *seed << 13;
	*seed ^= *seed >> 17;
	*seed ^= *seed << 5;
	return *seed;
}

static void tetrahedron(struct stream_mesh *mesh)
{
	struct stream_record piece = { STREAM_NONE, 4, { 0x0f } };

	CHECK(stream_mesh_init(mesh, VERTICES, TRIANGLES) == 0);
	CHECK(stream_record_fits(mesh, &piece));
	stream_mesh_apply(mesh, &piece);
}

/* The split of a vertex along the edges to the next vertices of two of its triangles, if the
 * surface around it is one fan without border: both are cut. */
static struct stream_record cut(const struct stream_mesh *mesh, uint32_t target, uint32_t *seed)
{
	struct stream_record record = { target, 0, { 0 } };
	uint32_t next[STREAM_RING_MAX], before[STREAM_RING_MAX], degree = 0, at, left, right;

	for (at = mesh->first[target]; at != STREAM_NONE; at = mesh->next[at]) {
		if (degree == STREAM_RING_MAX)
			return record;
		next[degree] = mesh->triangles[at / 3][(at % 3 + 1) % 3];
		before[degree++] = mesh->triangles[at / 3][(at % 3 + 2) % 3];
	}
	left = random_next(seed) % degree;
	right = (left + 1 + random_next(seed) % (degree - 1)) % degree;
	/* From left's next vertex counter-clockwise to right's, the triangles move. */
	for (uint32_t i = left; i != right;) {
		uint32_t j = 0;

		record.moved |= 1u << i;
		while (next[j] != before[i])
			j++;
		i = j;
	}
	record.faces[0] = (uint8_t)(STREAM_FACE | left | STREAM_FACE_BACK);
	record.faces[1] = (uint8_t)(STREAM_FACE | right);
	return record;
}

/* Each edge is used once in each direction, and each vertex is in a triangle. */
static void check_closed(const struct stream_mesh *mesh)
{
	for (uint32_t v = 0; v < mesh->vertex_count; v++) {
		uint32_t sum = 0;

		CHECK(mesh->first[v] != STREAM_NONE);
		for (uint32_t at = mesh->first[v]; at != STREAM_NONE; at = mesh->next[at]) {
			uint32_t next = mesh->triangles[at / 3][(at % 3 + 1) % 3], matches = 0;

			CHECK(mesh->triangles[at / 3][at % 3] == v && next != v);
			for (uint32_t to = mesh->first[v]; to != STREAM_NONE; to = mesh->next[to])
				matches += mesh->triangles[to / 3][(to % 3 + 2) % 3] == next;
			CHECK(matches == 1);
			sum++;
		}
		CHECK(sum >= 2);
	}
}

static uint32_t grow(struct stream_mesh *mesh, struct stream_record *records, uint32_t seed)
{
	uint32_t count = 0;

	while (count < RECORDS) {
		struct stream_record record = { STREAM_NONE, 4, { 0xf0 } };

		if (random_next(&seed) % 50 != 0)
			record = cut(mesh, random_next(&seed) % mesh->vertex_count, &seed);
		if (!record.moved)
			continue;
		CHECK(stream_record_fits(mesh, &record));
		stream_mesh_apply(mesh, &record);
		records[count++] = record;
		if (count % 97 == 0)
			check_closed(mesh);
	}
	return count;
}

static void a_closed_surface_stays_closed_in_every_prefix(void **state)
{
	struct stream_record *records = calloc(RECORDS, sizeof(*records));
	struct stream_mesh mesh;

	(void)state;
	tetrahedron(&mesh);
	CHECK(grow(&mesh, records, 7) == RECORDS);
	check_closed(&mesh);
	CHECK(mesh.triangle_count ==
	      2 * mesh.vertex_count - 4 * (mesh.vertex_count - RECORDS - 1) / 3);
	stream_mesh_finish(&mesh);
	free(records);
}

static void undo_restores_every_list_bit_for_bit(void **state)
{
	struct stream_record *records = calloc(RECORDS, sizeof(*records));
	struct stream_mesh mesh, again;
	uint32_t seed = 11;

	(void)state;
	tetrahedron(&mesh);
	tetrahedron(&again);
	grow(&mesh, records, seed);
	for (uint32_t r = RECORDS; r > RECORDS / 3; r--)
		stream_mesh_undo(&mesh, &records[r - 1]);
	for (uint32_t r = 0; r < RECORDS / 3; r++)
		stream_mesh_apply(&again, &records[r]);
	CHECK(mesh.vertex_count == again.vertex_count);
	CHECK(mesh.triangle_count == again.triangle_count);
	CHECK(memcmp(mesh.triangles, again.triangles,
		     mesh.triangle_count * sizeof(*mesh.triangles)) == 0);
	CHECK(memcmp(mesh.first, again.first, mesh.vertex_count * sizeof(*mesh.first)) == 0);
	CHECK(memcmp(mesh.next, again.next, 3 * mesh.triangle_count * sizeof(*mesh.next)) == 0);
	for (uint32_t r = RECORDS / 3; r > 0; r--)
		stream_mesh_undo(&mesh, &records[r - 1]);
	CHECK(mesh.vertex_count == 4 && mesh.triangle_count == 4);
	check_closed(&mesh);
	stream_mesh_finish(&mesh);
	stream_mesh_finish(&again);
	free(records);
}

static void refuses_records_that_do_not_fit(void **state)
{
	const struct stream_record bad[] = {
		{ 4, 1, { 0 } },               /* no such vertex */
		{ 0, 8, { 0 } },               /* three triangles, the fourth moves */
		{ 0, 1, { STREAM_FACE | 3 } }, /* a face at the fourth */
		{ 0, 1, { 1 } },               /* a face that is none */
		{ 0, 1, { 0, STREAM_FACE } },  /* after a gap */
		{ STREAM_NONE, 5, { 1 } },     /* a piece of five vertices */
		{ STREAM_NONE, 3, { 1 } },     /* of three, with the fourth's triangle */
		{ STREAM_NONE, 4, { 1, 1 } },  /* with what a split has */
	};
	const struct stream_record good = { 0, 1, { STREAM_FACE | 2 } };
	struct stream_mesh mesh;

	(void)state;
	tetrahedron(&mesh);
	for (uint32_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++)
		CHECK(!stream_record_fits(&mesh, &bad[i]));
	CHECK(stream_record_fits(&mesh, &good));
	mesh.triangle_room = mesh.triangle_count;
	CHECK(!stream_record_fits(&mesh, &good));
	mesh.triangle_room++;
	mesh.vertex_room = mesh.vertex_count;
	CHECK(!stream_record_fits(&mesh, &good));
	stream_mesh_finish(&mesh);
	CHECK(stream_mesh_init(&mesh, STREAM_VERTICES_MAX + 1, 1) == -EINVAL);
	CHECK(stream_mesh_init(&mesh, 1, STREAM_TRIANGLES_MAX + 1) == -EINVAL);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_closed_surface_stays_closed_in_every_prefix),
		cmocka_unit_test(undo_restores_every_list_bit_for_bit),
		cmocka_unit_test(refuses_records_that_do_not_fit),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
