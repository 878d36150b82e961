/* Counts of what visitors look at. */
#include "storage/usage.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/bytes.h"
#include "tests/check.h"

enum { HOUR_S = 3600, DAY_S = 24 * HOUR_S };

static const int64_t noon = 1795953600; /* 2026-11-29T12:00 UTC */
static char folder[] = "/tmp/gopura-tally-XXXXXX", path[64], copy[64];

static int set_up(void **state)
{
	(void)state;
	memcpy(folder + strlen(folder) - 6, "XXXXXX", 6);
	CHECK(mkdtemp(folder) != NULL);
	snprintf(path, sizeof(path), "%s/visits.csv", folder);
	snprintf(copy, sizeof(copy), "%s/copy.csv", folder);
	return 0;
}

static int tear_down(void **state)
{
	(void)state;
	unlink(path);
	unlink(copy);
	return rmdir(folder);
}

static void says(const char *file, const char *expected)
{
	struct buffer text;

	buffer_init(&text, 1 << 20);
	CHECK(buffer_read_file(&text, file) == 0);
	buffer_put_u8(&text, 0);
	if (strcmp((char *)text.data, expected) != 0)
		fail_msg("%s says\n%s", file, text.data);
	buffer_finish(&text);
}

static void write_text(const char *text)
{
	CHECK(bytes_write_file((struct bytes){ (const uint8_t *)text, strlen(text) }, path) == 0);
}

static struct usage *begin(int64_t now_s)
{
	struct usage *usage;

	CHECK(usage_create(&usage, path, copy, now_s) == 0);
	return usage;
}

#define HEADER "hour,kind,what,language,count\n"

static void counts_by_hour_kind_part_and_language(void **state)
{
	struct usage *usage = begin(noon);

	(void)state;
	says(path, HEADER);
	usage_add(usage, USAGE_VISIT, "", "en", noon);
	usage_add(usage, USAGE_PART, "gate", "en", noon + 10);
	usage_add(usage, USAGE_PART, "gate", "en", noon + 20);
	usage_add(usage, USAGE_PART, "gate", "km", noon + 20);
	usage_add(usage, USAGE_PAGE, "gate", "en", noon + HOUR_S);
	says(path, HEADER); /* the disk is left alone until then */
	usage_write(usage);
	says(path, HEADER "2026-11-29T12,visit,,en,1\n2026-11-29T12,part,gate,en,2\n"
			  "2026-11-29T12,part,gate,km,1\n2026-11-29T13,page,gate,en,1\n");
	usage_destroy(usage);
}

static void sums_up_at_the_next_start(void **state)
{
	struct usage *usage = begin(noon);

	(void)state;
	for (int i = 0; i < 3; i++) {
		usage_add(usage, USAGE_LANGUAGE, "", "ja", noon);
		usage_add(usage, USAGE_SEARCH, "", "ja", noon);
		usage_write(usage);
	}
	usage_destroy(usage);
	usage = begin(noon);
	says(path, HEADER "2026-11-29T12,language,,ja,3\n2026-11-29T12,search,,ja,3\n");
	usage_add(usage, USAGE_SEARCH, "", "ja", noon);
	usage_destroy(usage);
	usage_destroy(begin(noon));
	says(path, HEADER "2026-11-29T12,language,,ja,3\n2026-11-29T12,search,,ja,4\n");
}

static void keeps_four_hundred_days(void **state)
{
	(void)state;
	write_text(HEADER "2025-10-25T11,visit,,en,5\n2025-10-25T12,visit,,en,6\n"
			  "unset,visit,,en,7\n2026-11-29T11,visit,,en,8\n");
	usage_destroy(begin(0)); /* a clock that nobody set forgets nothing */
	says(path, HEADER "2025-10-25T11,visit,,en,5\n2025-10-25T12,visit,,en,6\n"
			  "2026-11-29T11,visit,,en,8\nunset,visit,,en,7\n");
	usage_destroy(begin(noon));
	says(path, HEADER "2025-10-25T12,visit,,en,6\n2026-11-29T11,visit,,en,8\n"
			  "unset,visit,,en,7\n");
}

/* By a clock whose battery is empty, say. */
static void a_wrong_year_forgets_nothing(void **state)
{
	static const char counts[] = HEADER "2026-11-28T11,visit,,en,5\n2026-11-28T12,visit,,en,6\n"
					    "2026-11-29T11,visit,,en,8\n";

	(void)state;
	write_text(counts);
	for (int year = 0; year < 3; year++)
		usage_destroy(begin(noon + (int64_t)(20 + year) * 365 * DAY_S));
	says(path, counts);
}

/* Counts of many parts by a visitor, each a line of its own. */
static void visit(struct usage *usage)
{
	char part[24];

	for (int i = 0; i < 200; i++) {
		snprintf(part, sizeof(part), "part-%d", i);
		usage_add(usage, USAGE_PART, part, "en", noon);
	}
	usage_write(usage);
}

static void sums_up_in_a_terminal_that_is_never_switched_off(void **state)
{
	struct usage *usage = begin(noon);
	struct stat status, copied;

	(void)state;
	for (int i = 0; i < 1000; i++)
		visit(usage);
	CHECK(stat(path, &status) == 0 && status.st_size < 2 << 20);
	CHECK(stat(copy, &copied) == 0 && copied.st_size == status.st_size);
	usage_destroy(usage);
	usage_destroy(begin(noon));
	CHECK(stat(path, &status) == 0 && status.st_size < 200 * 50);
}

static void keeps_the_newest_of_a_file_that_is_too_large(void **state)
{
	static const char early[] = "2026-11-28T10,visit,,en,1\n";
	static const char late[] = "2026-11-29T11,visit,,en,8\n";
	const size_t line_bytes = sizeof(early) - 1;
	struct buffer text;
	char expected[200];

	(void)state;
	buffer_init(&text, 2 * USAGE_FILE_MAX);
	while (text.size <= USAGE_FILE_MAX)
		buffer_put(&text, early, line_bytes);
	buffer_put(&text, late, sizeof(late) - 1);
	CHECK(bytes_write_file(buffer_bytes(&text), path) == 0);
	buffer_finish(&text);
	usage_destroy(begin(noon));
	snprintf(expected, sizeof(expected), HEADER "2026-11-28T10,visit,,en,%zu\n%s",
		 (USAGE_FILE_MAX / 2 - (sizeof(late) - 1)) / line_bytes, late);
	says(path, expected);
	says(copy, expected);
}

static void leaves_out_what_is_no_count(void **state)
{
	(void)state;
	write_text(HEADER "2026-11-29T11,visit,,en,8\n2026-11-29T11,visit,,en\n"
			  "2026-11-29T1x,visit,,en,1\n2026-11-29T11,stroll,,en,1\n"
			  "2026-11-29T11,part,\"=cmd()\",en,1\n2026-11-29T11,part,a,en,-1\n"
			  "2026-11-29T11,part,a,en,1,1\n\n2026-11-29T11,part,a,en,1\n"
			  "2026-11-29T11,pa");
	usage_destroy(begin(noon));
	says(path, HEADER "2026-11-29T11,visit,,en,8\n2026-11-29T11,part,a,en,1\n");
}

static void the_copy_says_the_same_to_everybody(void **state)
{
	struct usage *usage;
	struct stat status;

	(void)state;
	write_text(HEADER "2026-11-29T11,visit,,en,8\n");
	usage = begin(noon);
	usage_add(usage, USAGE_PART, "gate", "en", noon);
	usage_write(usage);
	says(copy, HEADER "2026-11-29T11,visit,,en,8\n2026-11-29T12,part,gate,en,1\n");
	CHECK(stat(copy, &status) == 0 && (status.st_mode & 0777) == 0644);
	usage_destroy(usage);
}

/* A file that may have so many bytes; what is more of a write does not happen. */
static void limit(rlim_t bytes)
{
	struct rlimit size;

	CHECK(getrlimit(RLIMIT_FSIZE, &size) == 0);
	size.rlim_cur = bytes;
	CHECK(setrlimit(RLIMIT_FSIZE, &size) == 0);
}

static void counts_nothing_twice_where_the_disk_takes_a_part(void **state)
{
	static const char hour[] = "2026-11-29T12,part,gate,en,1\n";
	struct usage *usage = begin(noon);

	(void)state;
	signal(SIGXFSZ, SIG_IGN);
	usage_add(usage, USAGE_PART, "gate", "en", noon);
	usage_add(usage, USAGE_PART, "moat", "en", noon);
	usage_add(usage, USAGE_PART, "wall", "en", noon);
	limit(sizeof(HEADER) - 1 + 2 * (sizeof(hour) - 1) + 9); /* two lines, and a third begins */
	usage_write(usage);
	limit(RLIM_INFINITY);
	usage_destroy(usage);
	usage_destroy(begin(noon));
	says(path, HEADER "2026-11-29T12,part,gate,en,1\n"
			  "2026-11-29T12,part,moat,en,1\n"
			  "2026-11-29T12,part,wall,en,1\n");
}

static void goes_on_without_a_disk(void **state)
{
	struct usage *usage;

	(void)state;
	CHECK(usage_create(&usage, "/proc/nowhere/visits.csv", NULL, noon) == 0);
	for (int i = 0; i < 2000; i++) {
		char part[24];

		snprintf(part, sizeof(part), "part-%d", i);
		usage_add(usage, USAGE_PART, part, "en", noon);
	}
	usage_destroy(usage);
}

#define FILED(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)

int main(void)
{
	const struct CMUnitTest tests[] = {
		FILED(counts_by_hour_kind_part_and_language),
		FILED(sums_up_at_the_next_start),
		FILED(keeps_four_hundred_days),
		FILED(a_wrong_year_forgets_nothing),
		FILED(sums_up_in_a_terminal_that_is_never_switched_off),
		FILED(keeps_the_newest_of_a_file_that_is_too_large),
		FILED(leaves_out_what_is_no_count),
		FILED(the_copy_says_the_same_to_everybody),
		FILED(counts_nothing_twice_where_the_disk_takes_a_part),
		FILED(goes_on_without_a_disk),
	};

	setenv("TZ", "UTC", 1);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
