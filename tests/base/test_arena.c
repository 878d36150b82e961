#include "base/arena.h"

#include <stdalign.h>
#include <string.h>

#include "base/compiler.h"
#include "tests/check.h"

static void gives_zeroed_aligned_memory_of_its_own(void **state)
{
	struct arena arena = { .ceiling_bytes = 16 << 20 };
	uint8_t *kept[300];

	(void)state;
	/* small ones, and larger than a block */
	for (size_t i = 0; i < ARRAY_COUNT(kept); i++) {
		const size_t size = i % 100 == 99 ? 200000 : 1 + 37 * i;

		kept[i] = arena_alloc(&arena, size);
		CHECK(kept[i] && (uintptr_t)kept[i] % alignof(max_align_t) == 0);
		for (size_t k = 0; k < size; k++)
			CHECK(kept[i][k] == 0);
		memset(kept[i], (int)i, size);
	}
	for (size_t i = 0; i < ARRAY_COUNT(kept); i++)
		CHECK(kept[i][0] == (uint8_t)i);
	CHECK(strcmp(arena_text(&arena, "temple gate", 6), "temple") == 0);
	arena_finish(&arena);
	CHECK(arena.total_bytes == 0 && arena_alloc(&arena, 1));
	arena_finish(&arena);
}

static void ends_at_its_ceiling(void **state)
{
	struct arena arena = { .ceiling_bytes = 1 << 20 };
	size_t got = 0;

	(void)state;
	CHECK(!arena_alloc(&arena, SIZE_MAX) && !arena_alloc(&arena, (1 << 20) + 1));
	while (arena_alloc(&arena, 1000))
		got += 1000;
	CHECK(got <= 1 << 20 && got > (1 << 20) - (64 << 10) - 20000);
	arena_finish(&arena);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(gives_zeroed_aligned_memory_of_its_own),
		cmocka_unit_test(ends_at_its_ceiling),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
