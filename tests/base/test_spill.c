/* Large arrays in files: their contents stay, what is resident stays bounded, and what lacks is an
 * error. */
#include "base/spill.h"

#include <errno.h>
#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

enum { LARGE_BYTES = SPILL_MIN_BYTES + 12345 };

static uint64_t value_at(size_t i)
{
	return i * 0x9e3779b97f4a7c15u;
}

static void fill(uint64_t *array, size_t from, size_t count)
{
	for (size_t i = from; i < count; i++) {
		array[i] = value_at(i);
		if (i % 65536 == 0)
			spill_breathe();
	}
}

static void check(const uint64_t *array, size_t count)
{
	for (size_t i = 0; i < count; i++)
		if (array[i] != value_at(i))
			fail_msg("item %zu is lost", i);
}

static void new_memory_is_zeroed_whatever_its_size(void **state)
{
	const size_t sizes[] = { 0, 1, 4096, LARGE_BYTES };

	(void)state;
	for (size_t s = 0; s < 4; s++) {
		uint8_t *array = spill_alloc(sizes[s]);

		assert_non_null(array);
		for (size_t i = 0; i < sizes[s]; i++)
			assert_int_equal(array[i], 0);
		spill_free(array);
	}
}

static void keeps_its_contents_as_it_grows_from_heap_to_file_and_back(void **state)
{
	const size_t counts[] = { 10, 1000, 5u << 20, 9u << 20, 6u << 20, 7u << 20, 100 };
	uint64_t *array = NULL;
	size_t count = 0;

	(void)state;
	for (size_t s = 0; s < sizeof(counts) / sizeof(counts[0]); s++) {
		assert_int_equal(SPILL_RESIZE(array, count, counts[s]), 0);
		check(array, count < counts[s] ? count : counts[s]);
		for (size_t i = count; i < counts[s]; i++)
			assert_true(array[i] == 0);
		fill(array, count, counts[s]);
		count = counts[s];
	}
	check(array, count);
	spill_free(array);
}

static void takes_over_memory_of_malloc(void **state)
{
	uint64_t *array = malloc(100 * sizeof(*array));

	(void)state;
	fill(array, 0, 100);
	assert_int_equal(SPILL_RESIZE(array, 100, LARGE_BYTES / sizeof(*array)), 0);
	check(array, 100);
	spill_free(array);
	spill_free(malloc(8));
	spill_free(NULL);
}

static uint64_t resident_kib(void)
{
	unsigned long long kib = 0;
	char line[256];
	FILE *file = fopen("/proc/self/status", "r");

	while (fgets(line, sizeof(line), file))
		if (sscanf(line, "VmRSS: %llu", &kib) == 1)
			break;
	fclose(file);
	return kib;
}

static void what_is_discarded_takes_nothing_with_it(void **state)
{
	const size_t count = 32u << 20, first = 1001, end = count - 77;
	uint64_t *array = spill_alloc(count * sizeof(*array)), small[10];
	uint64_t before_kib;

	(void)state;
	fill(array, 0, count);
	fill(small, 0, 10);
	before_kib = resident_kib();
	spill_discard(array + first, (end - first) * sizeof(*array));
	spill_discard(small + 1, 8 * sizeof(*small));
	spill_discard(array + 3, 8);
	check(array, first);
	for (size_t i = end; i < count; i++)
		assert_true(array[i] == value_at(i));
	check(small, 10);
	assert_true(before_kib - resident_kib() > (count * sizeof(*array) >> 10) / 2);
	spill_free(array);
}

static void maps_any_part_of_a_file(void **state)
{
	const size_t count = 8u << 20;
	char path[] = "/var/tmp/test_spill-XXXXXX";
	uint64_t *array = spill_alloc(count * sizeof(*array)), *part;
	int fd = mkstemp(path);

	(void)state;
	unlink(path);
	fill(array, 0, count);
	for (size_t done = 0; done < count * sizeof(*array);) {
		ssize_t got = write(fd, (uint8_t *)array + done, count * sizeof(*array) - done);

		assert_true(got > 0);
		done += (size_t)got;
	}
	spill_free(array);
	for (size_t from = 0; from < 1024; from += 511) { /* not at a page's beginning */
		part = spill_map(fd, from * sizeof(*part), (count - from) * sizeof(*part));
		assert_non_null(part);
		assert_true(part[0] == value_at(from) &&
			    part[count - from - 1] == value_at(count - 1));
		spill_free(part);
		part = spill_map(fd, from * sizeof(*part), 80);
		assert_non_null(part);
		assert_true(part[9] == value_at(from + 9));
		spill_free(part);
	}
	assert_null(spill_map(fd, count * sizeof(*part), 80));
	assert_int_equal(errno, EBADMSG);
	close(fd);
}

static void what_is_resident_stays_bounded(void **state)
{
	const size_t bytes = (size_t)1 << 30;
	uint8_t *array = spill_alloc(bytes);
	uint64_t most_kib = 0, kib;

	(void)state;
	assert_non_null(array);
	for (size_t i = 0; i < bytes; i += 4096) {
		array[i] = (uint8_t)(i >> 12);
		if (i % (64 << 20) == 0) {
			spill_breathe();
			kib = resident_kib();
			most_kib = kib > most_kib ? kib : most_kib;
		}
	}
	assert_true(most_kib < (SPILL_RESIDENT_BYTES >> 10) + (128 << 10));
	for (size_t i = 0; i < bytes; i += 4096)
		assert_int_equal(array[i], (uint8_t)(i >> 12));
	spill_free(array);
}

static void says_what_lacks(void **state)
{
	(void)state;
	spill_set_folder("/nowhere/at/all");
	assert_null(spill_alloc(LARGE_BYTES));
	assert_int_equal(errno, ENOENT);
	spill_set_folder("");
	assert_null(spill_alloc((size_t)1 << 60));
	assert_true(errno == ENOSPC || errno == EFBIG || errno == ENOMEM);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(new_memory_is_zeroed_whatever_its_size),
		cmocka_unit_test(keeps_its_contents_as_it_grows_from_heap_to_file_and_back),
		cmocka_unit_test(takes_over_memory_of_malloc),
		cmocka_unit_test(what_is_discarded_takes_nothing_with_it),
		cmocka_unit_test(maps_any_part_of_a_file),
		cmocka_unit_test(what_is_resident_stays_bounded),
		cmocka_unit_test(says_what_lacks),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
