#include "base/map.h"

#include "tests/check.h"

enum { KEYS = 3000 };

/* Low halves that differ from what the map makes of the high ones in few bits alone, so that
 * entries share homes and removal must shift. */
static map_key key_of(uint32_t n)
{
	return (map_key)n << 64 | (n * 0x9e3779b97f4a7c15u ^ n % 13);
}

static void finds_exactly_what_is_in_it(void **state)
{
	static bool there[KEYS];
	struct map map = { 0 };
	uint32_t x = 1;
	size_t count = 0;

	(void)state;
	CHECK(map_get(&map, key_of(1)) == MAP_NONE);
	map_remove(&map, key_of(1));
	for (int step = 0; step < 20000; step++) {
		uint32_t n = (x = x * 1664525 + 1013904223) >> 8;

		n %= step < 10000 ? KEYS : 200;
		if (there[n]) {
			map_remove(&map, key_of(n));
			count--;
		} else {
			CHECK(map_set(&map, key_of(n), n) == 0);
			count++;
		}
		there[n] = !there[n];
		CHECK(map.count == count);
		CHECK(map_get(&map, key_of(n)) == (there[n] ? n : MAP_NONE));
	}
	for (uint32_t n = 0; n < KEYS; n++)
		CHECK(map_get(&map, key_of(n)) == (there[n] ? n : MAP_NONE));
	map_finish(&map);
}

static void tells_keys_apart_by_all_their_bits(void **state)
{
	struct map map = { 0 };

	(void)state;
	for (int bit = 0; bit < 128; bit++)
		CHECK(map_add(&map, (map_key)1 << bit, (uint64_t)bit) == 1);
	CHECK(map_add(&map, 0, 128) == 1); /* zero is a key too */
	for (int bit = 0; bit < 128; bit++)
		CHECK(map_get(&map, (map_key)1 << bit) == (uint64_t)bit);
	CHECK(map_get(&map, 0) == 128 && map.count == 129);
	map_finish(&map);
}

static void setting_replaces_and_adding_keeps(void **state)
{
	struct map map = { 0 };

	(void)state;
	CHECK(map_set(&map, 5, 1) == 0 && map_set(&map, 5, 2) == 0);
	CHECK(map.count == 1 && map_get(&map, 5) == 2);
	CHECK(map_add(&map, 5, 3) == 0 && map_get(&map, 5) == 2);
	CHECK(map_add(&map, 6, 3) == 1 && map_get(&map, 6) == 3);
	map_clear(&map);
	CHECK(map_get(&map, 5) == MAP_NONE && map.count == 0);
	CHECK(map_add(&map, 5, 4) == 1 && map_get(&map, 5) == 4);
	map_finish(&map);
	map_finish(NULL);
}

static void goes_over_each_once(void **state)
{
	int seen[100] = { 0 };
	struct map map = { 0 };
	uint64_t value;
	map_key key = 0;
	size_t at = 0;

	(void)state;
	CHECK(map_next(&map, &at) == MAP_NONE);
	for (uint32_t n = 0; n < 100; n++)
		CHECK(map_set(&map, key_of(n), n) == 0);
	while ((value = map_next(&map, &at)) != MAP_NONE)
		seen[value]++;
	at = 0;
	while (map_next_key(&map, &at, &key))
		seen[key >> 64]++;
	for (int n = 0; n < 100; n++)
		CHECK(seen[n] == 2);
	map_finish(&map);
}

static void holds_pointers(void **state)
{
	struct map map = { 0 };
	size_t at = 0;
	int here;

	(void)state;
	CHECK(map_get_pointer(&map, 1) == NULL && map_next_pointer(&map, &at) == NULL);
	CHECK(map_set(&map, 1, (uintptr_t)&here) == 0);
	CHECK(map_get_pointer(&map, 1) == &here && map_get_pointer(&map, 2) == NULL);
	at = 0;
	CHECK(map_next_pointer(&map, &at) == &here && map_next_pointer(&map, &at) == NULL);
	map_finish(&map);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(finds_exactly_what_is_in_it),
		cmocka_unit_test(tells_keys_apart_by_all_their_bits),
		cmocka_unit_test(setting_replaces_and_adding_keeps),
		cmocka_unit_test(goes_over_each_once),
		cmocka_unit_test(holds_pointers),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
