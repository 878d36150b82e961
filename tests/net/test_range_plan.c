#include "net/range_plan.h"

#include "base/compiler.h"
#include "tests/check.h"

static const struct hash first_pack = { { 1 } }, second_pack = { { 2 } };
static const struct range_limits limits = { .gap_bytes = 10,
					    .most_bytes = 1000,
					    .ahead_bytes = 1000 };

static struct range_item item(struct hash pack, uint64_t place, uint32_t size, uint32_t priority)
{
	static uint64_t order;

	return (struct range_item){
		.pack = pack, .place = place, .size = size, .priority = priority, .order = order++
	};
}

static void takes_neighbours_across_small_gaps(void **state)
{
	struct range_item items[] = {
		item(first_pack, 0, 100, 1),   item(first_pack, 105, 100, 5),
		item(first_pack, 205, 50, 1),  item(first_pack, 266, 50, 9), /* a gap of 11 */
		item(second_pack, 316, 50, 1),
	};
	size_t first;

	(void)state;
	CHECK(range_plan(items, ARRAY_COUNT(items), limits, &first) == 1 && first == 3);
	CHECK(range_plan(items, ARRAY_COUNT(items), limits, &first) == 3 && first == 0);
	CHECK(range_plan(items, ARRAY_COUNT(items), limits, &first) == 1 && first == 4);
	CHECK(range_plan(items, ARRAY_COUNT(items), limits, &first) == 0);
}

static void stays_within_its_ceiling_but_takes_a_large_object_alone(void **state)
{
	struct range_item items[] = {
		item(first_pack, 0, 600, 1),
		item(first_pack, 600, 500, 9),
		item(first_pack, 1100, 300, 1),
		item(first_pack, 1400, 5000, 2),
	};
	size_t first;

	(void)state;
	/* 500 + 300 fit, 600 + 500 do not, nor does the largest */
	CHECK(range_plan(items, ARRAY_COUNT(items), limits, &first) == 2 && first == 1);
	CHECK(range_plan(items, ARRAY_COUNT(items), limits, &first) == 1 && first == 3);
	CHECK(range_plan(items, ARRAY_COUNT(items), limits, &first) == 1 && first == 0);
}

static void grows_towards_the_higher_priority(void **state)
{
	struct range_item items[] = {
		item(first_pack, 0, 400, 1),
		item(first_pack, 400, 400, 9),
		item(first_pack, 800, 400, 5),
	};
	size_t first;

	(void)state;
	CHECK(range_plan(items, ARRAY_COUNT(items), limits, &first) == 2 && first == 1);
}

static void the_most_urgent_waits_for_little_only(void **state)
{
	const struct range_limits narrow = { .gap_bytes = 10,
					     .most_bytes = 1000,
					     .ahead_bytes = 150 };
	struct range_item items[] = {
		item(first_pack, 0, 200, 1),
		item(first_pack, 200, 100, 1),
		item(first_pack, 300, 100, 9),
		item(first_pack, 400, 100, 1),
	};
	size_t first;

	(void)state;
	CHECK(range_plan(items, ARRAY_COUNT(items), narrow, &first) == 3 && first == 1);
	CHECK(range_plan(items, ARRAY_COUNT(items), narrow, &first) == 1 && first == 0);
}

static void asks_first_for_what_was_wanted_first(void **state)
{
	struct range_item items[] = {
		item(second_pack, 0, 10, 3), /* said first, but in a later pack */
		item(first_pack, 0, 10, 3),
		item(first_pack, 500, 10, 3),
	};
	size_t first;

	(void)state;
	range_sort(items, ARRAY_COUNT(items));
	CHECK(hash_equal(items[0].pack, first_pack) && items[0].place == 0);
	CHECK(hash_equal(items[2].pack, second_pack));
	CHECK(range_plan(items, ARRAY_COUNT(items), limits, &first) == 1 && first == 2);
}

/* Two objects cannot share bytes: one of the places is a lie, and must not spoil the other. */
static void keeps_overlapping_places_apart(void **state)
{
	struct range_item items[] = {
		item(first_pack, 0, 100, 9),
		item(first_pack, 50, 100, 1),
		item(first_pack, 50, 100, 1),
		item(first_pack, 150, 100, 1),
	};
	size_t first;

	(void)state;
	CHECK(range_plan(items, ARRAY_COUNT(items), limits, &first) == 1 && first == 0);
	CHECK(range_plan(items, ARRAY_COUNT(items), limits, &first) == 1 && first == 1);
	CHECK(range_plan(items, ARRAY_COUNT(items), limits, &first) == 2 && first == 2);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(takes_neighbours_across_small_gaps),
		cmocka_unit_test(stays_within_its_ceiling_but_takes_a_large_object_alone),
		cmocka_unit_test(grows_towards_the_higher_priority),
		cmocka_unit_test(the_most_urgent_waits_for_little_only),
		cmocka_unit_test(asks_first_for_what_was_wanted_first),
		cmocka_unit_test(keeps_overlapping_places_apart),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
