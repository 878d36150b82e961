#include "base/array.h"

#include <errno.h>
#include <stdlib.h>

#include "tests/check.h"

struct item {
	uint32_t number;
	char text[12];
};

struct list {
	struct item *items;
	uint32_t count, room;
};

static int add(struct list *list, uint32_t number, uint32_t most)
{
	int rc = ARRAY_RESERVE(list->items, list->room, list->count + 1, most);

	if (rc == 0)
		list->items[list->count++].number = number;
	return rc;
}

static void keeps_its_items_while_it_grows(void **state)
{
	struct list list = { 0 };

	(void)state;
	for (uint32_t i = 0; i < 10000; i++)
		CHECK(add(&list, i, UINT32_MAX) == 0);
	for (uint32_t i = 0; i < 10000; i++)
		CHECK(list.items[i].number == i);
	CHECK(list.room >= list.count && list.room < 2 * list.count + 16);
	free(list.items);
}

static void keeps_its_room_where_it_suffices(void **state)
{
	struct list list = { 0 };
	const struct item *before;

	(void)state;
	CHECK(ARRAY_RESERVE(list.items, list.room, 100, 1000) == 0);
	before = list.items;
	CHECK(list.room == 100);
	CHECK(ARRAY_RESERVE(list.items, list.room, 100, 1000) == 0);
	CHECK(ARRAY_RESERVE(list.items, list.room, 0, 0) == 0);
	CHECK(list.items == before && list.room == 100);
	free(list.items);
}

static void refuses_more_than_its_ceiling(void **state)
{
	struct list list = { 0 };

	(void)state;
	for (uint32_t i = 0; i < 37; i++)
		CHECK(add(&list, i, 37) == 0);
	CHECK(list.room == 37);
	CHECK(add(&list, 37, 37) == -EFBIG);
	CHECK(list.count == 37 && list.room == 37 && list.items[36].number == 36);
	CHECK(ARRAY_RESERVE(list.items, list.room, (uint64_t)UINT32_MAX + 1, UINT32_MAX) == -EFBIG);
	free(list.items);
}

static void changes_nothing_without_memory(void **state)
{
	struct list list = { 0 };
	struct item *before;

	(void)state;
	CHECK(add(&list, 7, UINT32_MAX) == 0);
	before = list.items;
	CHECK(array_reserve(&list.items, &list.room, UINT32_MAX, UINT32_MAX, SIZE_MAX / 1024) ==
	      -ENOMEM);
	CHECK(list.items == before && list.room == 16 && list.items[0].number == 7);
	free(list.items);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(keeps_its_items_while_it_grows),
		cmocka_unit_test(keeps_its_room_where_it_suffices),
		cmocka_unit_test(refuses_more_than_its_ceiling),
		cmocka_unit_test(changes_nothing_without_memory),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
