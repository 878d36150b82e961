#include <pthread.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "base/progress.h"
#include "tests/check.h"

/* The clock of this program, instead of the archive's. */
static int64_t now_ms;

int64_t clock_now_ms(void)
{
	return now_ms;
}

int64_t clock_now_us(void)
{
	return now_ms * 1000;
}

static void says_how_far_how_fast_how_long(void **state)
{
	struct progress *progress = progress_start("sampling", "faces", 400);
	char line[200];

	(void)state;
	progress_add(progress, 100);
	progress_line(progress, line, sizeof(line), 100, 10000);
	CHECK(strstr(line, "sampling [#######...") == line);
	CHECK(strstr(line, " 25 %  100 of 400 faces  10/s  30 s left"));
	progress_add(progress, 300);
	progress_line(progress, line, sizeof(line), 100, 20000);
	CHECK(strstr(line, "100 %") && !strchr(line, '.') && strstr(line, "0 s left"));
	progress_end(progress);
}

static void fits_narrow_terminals_and_unknown_totals(void **state)
{
	struct progress *progress = progress_start("reading", "triangles", 0);
	char line[200];

	(void)state;
	progress_add(progress, 3000000);
	progress_line(progress, line, sizeof(line), 80, 2000);
	CHECK(strcmp(line, "reading  3000.0 k triangles  1500.0 k/s") == 0);
	progress_set_total(progress, 6000000);
	progress_line(progress, line, sizeof(line), 40, 2000);
	CHECK(strstr(line, "50 %") && !strchr(line, '['));
	progress_end(progress);
}

static void takes_null_for_show_nothing(void **state)
{
	(void)state;
	progress_add(NULL, 1);
	progress_set_total(NULL, 1);
	progress_end(NULL);
}

static void *add_many(void *data)
{
	for (int i = 0; i < 10000; i++)
		progress_add(data, 1);
	return NULL;
}

static void counts_from_any_thread(void **state)
{
	struct progress *progress = progress_start("work", "steps", 0);
	pthread_t threads[4];
	char line[100];

	(void)state;
	for (int i = 0; i < 4; i++)
		CHECK(pthread_create(&threads[i], NULL, add_many, progress) == 0);
	for (int i = 0; i < 4; i++)
		pthread_join(threads[i], NULL);
	progress_line(progress, line, sizeof(line), 80, 1000);
	CHECK(strstr(line, "40.0 k steps"));
	progress_end(progress);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(says_how_far_how_fast_how_long),
		cmocka_unit_test(fits_narrow_terminals_and_unknown_totals),
		cmocka_unit_test(takes_null_for_show_nothing),
		cmocka_unit_test(counts_from_any_thread),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
