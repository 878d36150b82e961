#include <string.h>

#include "render/plan/cell_map.h"
#include "tests/check.h"

static void finds_what_was_set_and_not_what_was_removed(void **state)
{
	(void)state;
	enum { KEYS = 2000 };
	struct map map = { 0 };
	CHECK(map_get(&map, 7) == MAP_NONE);
	for (uint64_t key = 0; key < KEYS; key++)
		CHECK(map_set(&map, key * 977, (uint32_t)key) == 0);
	for (uint64_t key = 0; key < KEYS; key += 3)
		map_remove(&map, key * 977);
	map_remove(&map, 1); /* was never there */
	for (uint64_t key = 0; key < KEYS; key++)
		CHECK(map_get(&map, key * 977) == (key % 3 ? (uint32_t)key : MAP_NONE));
	CHECK(map.count == KEYS - (KEYS + 2) / 3);
	map_finish(&map);
}

static void replaces_a_value_and_clears(void **state)
{
	(void)state;
	struct map map = { 0 };
	CHECK(map_set(&map, 5, 1) == 0 && map_set(&map, 5, 2) == 0);
	CHECK(map.count == 1 && map_get(&map, 5) == 2);
	map_clear(&map);
	CHECK(map_get(&map, 5) == MAP_NONE && map.count == 0);
	map_finish(&map);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(finds_what_was_set_and_not_what_was_removed),
		cmocka_unit_test(replaces_a_value_and_clears),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
