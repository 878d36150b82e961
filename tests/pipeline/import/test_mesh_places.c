/* Equal vertices, compared with what sorting finds. */
#include "pipeline/import/mesh_places.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/spill.h"
#include "tests/check.h"

enum { VERTICES = 250000 }; /* several parts and ranges */

static struct mesh mesh;
static uint32_t order[VERTICES], expected[VERTICES];

static uint32_t next_random(void)
{
	static uint64_t state = 1;

	state = state * 6364136223846793005u + 1442695040888963407u;
	return (uint32_t)(state >> 33);
}

/* At each of `places` places, vertices of up to `looks` colours. */
static void make(uint32_t places, uint32_t looks)
{
	for (uint32_t i = 0; i < VERTICES; i++) {
		uint32_t place = next_random() % places;

		for (int k = 0; k < 3; k++)
			mesh.positions[i][k] = (float)(place >> (4 * k)) + 0.25f;
		memset(mesh.colours[i], 0, sizeof(mesh.colours[i]));
		mesh.colours[i][0] = (uint8_t)(next_random() % looks);
	}
}

static int compare_looks(uint32_t a, uint32_t b, bool place_only)
{
	int by = memcmp(mesh.positions[a], mesh.positions[b], sizeof(mesh.positions[a]));

	return by != 0 || place_only ? by : memcmp(mesh.colours[a], mesh.colours[b], 4);
}

static int by_place(const void *a, const void *b)
{
	uint32_t left = *(const uint32_t *)a, right = *(const uint32_t *)b;
	int by = compare_looks(left, right, true);

	return by ? by : (left > right) - (left < right);
}

static int by_looks(const void *a, const void *b)
{
	uint32_t left = *(const uint32_t *)a, right = *(const uint32_t *)b;
	int by = compare_looks(left, right, false);

	return by ? by : (left > right) - (left < right);
}

static void expect(bool place_only)
{
	for (uint32_t i = 0; i < VERTICES; i++)
		order[i] = i;
	qsort(order, VERTICES, sizeof(order[0]), place_only ? by_place : by_looks);
	for (uint32_t i = 0; i < VERTICES; i++)
		expected[order[i]] = i > 0 && compare_looks(order[i - 1], order[i], place_only) == 0
					     ? expected[order[i - 1]]
					     : order[i];
}

static void finds_the_first_of_equal_vertices(void **state)
{
	(void)state;

	make(20000, 3);
	for (uint32_t jobs = 1; jobs <= 3; jobs++) {
		uint32_t *place, *equal;

		expect(true);
		CHECK(mesh_places(&place, &mesh, jobs) == 0 && place);
		CHECK(memcmp(place, expected, sizeof(expected)) == 0);
		expect(false);
		CHECK(mesh_equals(&equal, &mesh, place, jobs) == 0 && equal != place);
		CHECK(memcmp(equal, expected, sizeof(expected)) == 0);
		spill_free(equal);
		spill_free(place);
	}
}

static void many_looks_at_one_place_are_told_apart(void **state)
{
	uint32_t *place, *equal;
	(void)state;

	for (uint32_t i = 0; i < VERTICES; i++) {
		memset(mesh.positions[i], 0, sizeof(mesh.positions[i]));
		memcpy(mesh.colours[i], &i, sizeof(i));
	}
	memcpy(mesh.colours[VERTICES - 1], mesh.colours[5], 4);
	CHECK(mesh_places(&place, &mesh, 2) == 0 && place[0] == 0 && place[VERTICES - 1] == 0);
	CHECK(mesh_equals(&equal, &mesh, place, 2) == 0 && equal != place);
	for (uint32_t i = 0; i < VERTICES - 1; i++)
		CHECK(equal[i] == i);
	CHECK(equal[VERTICES - 1] == 5);
	spill_free(equal);
	spill_free(place);
}

static void without_equals_there_is_no_list(void **state)
{
	uint32_t *place, *equal;
	(void)state;

	for (uint32_t i = 0; i < VERTICES; i++)
		mesh.positions[i][0] = (float)i;
	CHECK(mesh_places(&place, &mesh, 2) == 0 && !place);
	CHECK(mesh_equals(&equal, &mesh, place, 2) == 0 && !equal);
}

static void vertices_that_look_alike_need_no_second_list(void **state)
{
	uint32_t *place, *equal;
	(void)state;

	make(20000, 1);
	CHECK(mesh_places(&place, &mesh, 2) == 0 && place);
	CHECK(mesh_equals(&equal, &mesh, place, 2) == 0 && equal == place);
	spill_free(place);
}

int main(void)
{
	static float positions[VERTICES][3];
	static uint8_t colours[VERTICES][4];
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(finds_the_first_of_equal_vertices),
		cmocka_unit_test(many_looks_at_one_place_are_told_apart),
		cmocka_unit_test(without_equals_there_is_no_list),
		cmocka_unit_test(vertices_that_look_alike_need_no_second_list),
	};

	mesh = (struct mesh){ .vertex_count = VERTICES,
			      .positions = positions,
			      .colours = colours };
	return cmocka_run_group_tests(tests, NULL, NULL);
}
