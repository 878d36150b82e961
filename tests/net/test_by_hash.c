#include "net/by_hash.h"

#include <stdlib.h>
#include <string.h>

#include "tests/check.h"

enum { ENTRIES = 3000 };

/* Few homes, so that entries collide and removal must shift. */
static struct hash key(uint32_t n)
{
	struct hash hash = { { 0 } };

	hash.bytes[0] = (uint8_t)(n % 13);
	memcpy(hash.bytes + 8, &n, sizeof(n));
	return hash;
}

static void finds_exactly_what_is_in_it(void **state)
{
	static struct hash_entry entries[ENTRIES];
	bool there[ENTRIES] = { false };
	struct by_hash map = { 0 };
	uint32_t x = 1;
	size_t count = 0;

	(void)state;
	CHECK(by_hash_find(&map, key(1)) == NULL);
	by_hash_remove(&map, key(1));
	for (int step = 0; step < 20000; step++) {
		uint32_t n = (x = x * 1664525 + 1013904223) >> 8;

		n %= step < 10000 ? ENTRIES : 200;
		if (there[n]) {
			by_hash_remove(&map, key(n));
			count--;
		} else {
			entries[n].key = key(n);
			CHECK(by_hash_add(&map, &entries[n]) == 0);
			count++;
		}
		there[n] = !there[n];
		CHECK(map.count == count);
		CHECK((by_hash_find(&map, key(n)) == &entries[n]) == there[n]);
	}
	for (uint32_t n = 0; n < ENTRIES; n++)
		CHECK(by_hash_find(&map, key(n)) == (there[n] ? &entries[n] : NULL));
	by_hash_finish(&map);
}

static void walks_over_each_once(void **state)
{
	static struct hash_entry entries[100];
	int seen[100] = { 0 };
	struct by_hash map = { 0 };
	struct hash_entry *entry;
	size_t at = 0;

	(void)state;
	CHECK(by_hash_next(&map, &at) == NULL);
	for (uint32_t n = 0; n < 100; n++) {
		entries[n].key = key(n);
		CHECK(by_hash_add(&map, &entries[n]) == 0);
	}
	while ((entry = by_hash_next(&map, &at)))
		seen[entry - entries]++;
	for (int n = 0; n < 100; n++)
		CHECK(seen[n] == 1);
	by_hash_finish(&map);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(finds_exactly_what_is_in_it),
		cmocka_unit_test(walks_over_each_once),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
