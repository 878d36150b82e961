/* What the key of the labels depends on, and that labels come back only under their key. */
#include "pipeline/release/label_cache.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/compiler.h"
#include "tests/check.h"

static const struct region prism = { .kind = REGION_PRISM,
				     .floor_m = 1,
				     .roof_m = 2,
				     .corner_count = 3,
				     .corners_m = { { 0, 0 }, { 1, 0 }, { 1, 1 } } };

static struct hash key_of(const struct label_source_part *parts, uint32_t count)
{
	const struct hash scans = { { 1 } }, hierarchy = { { 2 } };
	struct hash key;

	CHECK(label_cache_key(&key, scans, hierarchy, parts, count) == 0);
	return key;
}

static struct hash key_of_region(struct region region)
{
	const struct label_source_part part = { .id = "gate", .region = region };

	return key_of(&part, 1);
}

static void every_field_of_a_region_counts(void **state)
{
	struct region changed[11];
	struct hash keys[ARRAY_COUNT(changed) + 1];

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(changed); i++)
		changed[i] = prism;
	changed[0].kind = REGION_BOX;
	changed[1].centre_m[2] = 3;
	changed[2].radius_m = 3;
	changed[3].half_m[1] = 3;
	changed[4].turn_deg = 3;
	changed[5].floor_m = 0;
	changed[6].roof_m = 3;
	changed[7].corner_count = 2;
	changed[8].corners_m[0][0] = -1;
	changed[9].corners_m[2][1] = 3;
	changed[10].centre_m[0] = 3;
	keys[0] = key_of_region(prism);
	for (size_t i = 0; i < ARRAY_COUNT(changed); i++) {
		keys[i + 1] = key_of_region(changed[i]);
		for (size_t k = 0; k <= i; k++)
			if (hash_equal(keys[k], keys[i + 1]))
				fail_msg("cases %zu and %zu have one key", k, i + 1);
	}
}

static void corners_that_are_not_used_do_not_count(void **state)
{
	struct region region = prism;

	(void)state;
	region.corners_m[3][0] = 7;
	CHECK(hash_equal(key_of_region(prism), key_of_region(region)));
}

static void what_a_part_is_counts(void **state)
{
	struct label_source_part a = { .id = "gate", .region = prism }, b = a;

	(void)state;
	b.id = "tower";
	CHECK(!hash_equal(key_of(&a, 1), key_of(&b, 1)));
	b = a;
	b.is_list = true;
	CHECK(!hash_equal(key_of(&a, 1), key_of(&b, 1)));
	b = a;
	b.list.bytes[HASH_BYTES - 1] = 1;
	CHECK(!hash_equal(key_of(&a, 1), key_of(&b, 1)));
	CHECK(!hash_equal(key_of(&a, 1), key_of(&a, 0)));
}

static void the_scans_and_the_hierarchy_count(void **state)
{
	const struct hash one = { { 1 } }, two = { { 2 } };
	struct hash keys[3];

	(void)state;
	CHECK(label_cache_key(&keys[0], one, two, NULL, 0) == 0);
	CHECK(label_cache_key(&keys[1], two, two, NULL, 0) == 0);
	CHECK(label_cache_key(&keys[2], one, one, NULL, 0) == 0);
	CHECK(!hash_equal(keys[0], keys[1]) && !hash_equal(keys[0], keys[2]));
}

static void labels_come_back_under_their_key_alone(void **state)
{
	const struct hash one = { { 1 } }, two = { { 2 } };
	char path[] = "/tmp/gopura-labels-XXXXXX";
	struct buffer saved[2], loaded[2];
	int fd = mkstemp(path);

	(void)state;
	CHECK(fd >= 0);
	close(fd);
	for (int i = 0; i < 2; i++) {
		buffer_init(&saved[i], 100);
		buffer_init(&loaded[i], 100);
	}
	buffer_put_string(&saved[0], "gate");
	CHECK(label_cache_save(saved, 2, one, path) == 0);
	CHECK(label_cache_load(loaded, 2, two, path) < 0);
	CHECK(label_cache_load(loaded, 1, one, path) < 0);
	CHECK(label_cache_load(loaded, 2, one, path) == 0);
	CHECK(loaded[0].size == saved[0].size && loaded[1].size == 0);
	CHECK(memcmp(loaded[0].data, saved[0].data, saved[0].size) == 0);
	for (int i = 0; i < 2; i++) {
		buffer_finish(&saved[i]);
		buffer_finish(&loaded[i]);
	}
	unlink(path);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_field_of_a_region_counts),
		cmocka_unit_test(corners_that_are_not_used_do_not_count),
		cmocka_unit_test(what_a_part_is_counts),
		cmocka_unit_test(the_scans_and_the_hierarchy_count),
		cmocka_unit_test(labels_come_back_under_their_key_alone),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
