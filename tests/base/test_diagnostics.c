/* What becomes of diagnostics in a list: their texts, their order, and what does not fit. */
#include "base/diagnostics.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "tests/check.h"

static void says_the_place_before_the_sentence(void **state)
{
	static const struct {
		const char *file;
		unsigned line;
		const char *text;
	} cases[] = {
		{ "a.ply", 7, "a.ply:7: face 3 is odd" },
		{ "a.ply", 0, "a.ply: face 3 is odd" },
		{ NULL, 7, "line 7: face 3 is odd" },
		{ NULL, 0, "face 3 is odd" },
	};

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		struct diagnostics d = { 0 };

		CHECK(diagnostics_add(&d, -EBADMSG, cases[i].file, cases[i].line, "face %d is odd",
				      3) == -EBADMSG);
		CHECK(d.count == 1 && d.error_count == 1);
		CHECK(d.first.error == -EBADMSG && d.first.line == cases[i].line);
		CHECK(strcmp(d.first.text, cases[i].text) == 0);
		CHECK(strcmp(d.first.text + d.first.place_bytes, "face 3 is odd") == 0);
	}
}

static void a_zeroed_list_keeps_the_cause_alone(void **state)
{
	struct diagnostics d = { 0 };

	(void)state;
	CHECK(strcmp(diagnostics_cause(&d, -ENOSPC), strerror(ENOSPC)) == 0);
	CHECK(diagnostics_add(&d, -EBADMSG, "a.ply", 0, "it is cut off") == -EBADMSG);
	CHECK(diagnostics_add(&d, -EIO, "temple", 0, "reading fails") == -EIO);
	CHECK(strcmp(diagnostics_cause(&d, -EIO), "a.ply: it is cut off") == 0);
	CHECK(d.count == 1 && d.dropped == 1 && diagnostics_total(&d) == 2 && !d.more);
}

static void an_error_is_the_cause_whatever_was_warned_of_before(void **state)
{
	struct diagnostics lists[] = { { .max = 0 }, { .max = 1 }, { .max = 4 } };

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(lists); i++) {
		struct diagnostics *d = &lists[i];

		diagnostics_add(d, 0, "a.html", 3, "left out");
		CHECK(strcmp(diagnostics_cause(d, -EIO), "a.html:3: left out") == 0);
		diagnostics_add(d, -EINVAL, "b.html", 0, "has no title");
		diagnostics_add(d, -EIO, NULL, 0, "no preview");
		CHECK(strcmp(diagnostics_cause(d, -EIO), "b.html: has no title") == 0);
		CHECK(diagnostics_total(d) == 3 && d->error_count == 2);
		diagnostics_finish(d);
	}
}

static void warnings_that_fill_a_list_leave_room_for_an_error(void **state)
{
	struct diagnostics d = { .max = 2 };

	(void)state;
	for (unsigned line = 1; line <= 3; line++)
		diagnostics_add(&d, 0, "a.html", line, "left out");
	diagnostics_add(&d, -EINVAL, "b.html", 0, "has no title");
	diagnostics_add(&d, -EIO, NULL, 0, "no preview");
	CHECK(strcmp(diagnostics_cause(&d, -EIO), "b.html: has no title") == 0);
	CHECK(d.count == 2 && diagnostics_get(&d, 0)->line == 1 && diagnostics_total(&d) == 5);
	diagnostics_finish(&d);
}

static void no_list_takes_nothing(void **state)
{
	(void)state;
	CHECK(diagnostics_add(NULL, -EBADMSG, "a.ply", 1, "it is cut off") == -EBADMSG);
	diagnostics_finish(NULL);
}

static void counts_what_does_not_fit(void **state)
{
	struct diagnostics d = { .max = 3 };

	(void)state;
	for (unsigned i = 1; i <= 5; i++)
		CHECK(diagnostics_add(&d, i % 2 ? -EINVAL : 0, NULL, i, "odd") ==
		      (i % 2 ? -EINVAL : 0));
	CHECK(d.count == 3 && d.dropped == 2 && d.error_count == 3 && diagnostics_total(&d) == 5);
	for (unsigned i = 0; i < 3; i++)
		CHECK(diagnostics_get(&d, i)->line == i + 1);
	diagnostics_finish(&d);
	CHECK(d.count == 0 && d.dropped == 0 && d.error_count == 0 && d.max == 3);
}

static void orders_by_lines_and_keeps_the_rest(void **state)
{
	static const unsigned lines[] = { 0, 5, 2, 5, 0, 1 };
	static const char *const expected[] = { "line 1: 5", "line 2: 2", "line 5: 1",
						"line 5: 3", "0",         "4" };
	struct diagnostics d = { .max = ARRAY_COUNT(lines) };

	(void)state;
	for (unsigned i = 0; i < ARRAY_COUNT(lines); i++)
		diagnostics_add(&d, -EINVAL, NULL, lines[i], "%u", i);
	diagnostics_sort(&d);
	for (unsigned i = 0; i < ARRAY_COUNT(lines); i++)
		CHECK(strcmp(diagnostics_get(&d, i)->text, expected[i]) == 0);
	diagnostics_finish(&d);
}

static void replaces_what_cannot_be_printed(void **state)
{
	struct diagnostics d = { 0 };

	(void)state;
	diagnostics_add(&d, -EINVAL, "a\x1b.ply", 0, "\xff and\n %s", "\xe1\x9e\x80");
	CHECK(strcmp(d.first.text, "a?.ply: ? and? \xe1\x9e\x80") == 0);
}

static void cuts_a_text_too_long_between_characters(void **state)
{
	char file[DIAGNOSTIC_BYTES + 10], sentence[2 * DIAGNOSTIC_BYTES];
	struct diagnostics d = { .max = 2 };

	(void)state;
	memset(file, 'f', sizeof(file) - 1);
	file[sizeof(file) - 1] = '\0';
	for (size_t i = 0; i + 3 < sizeof(sentence); i += 3)
		memcpy(sentence + i, "\xe1\x9e\x80", 4);
	diagnostics_add(&d, -EINVAL, file, 7, "%s", sentence);
	CHECK(strlen(d.first.text) == DIAGNOSTIC_BYTES - 1);
	CHECK(d.first.place_bytes < DIAGNOSTIC_BYTES);
	diagnostics_add(&d, -EINVAL, "a", 0, "%s", sentence);
	CHECK(strlen(diagnostics_get(&d, 1)->text) == 3 + (DIAGNOSTIC_BYTES - 4) / 3 * 3);
	CHECK(!strchr(diagnostics_get(&d, 1)->text, '?'));
	diagnostics_finish(&d);
}

static void prints_all_and_how_many_are_missing(void **state)
{
	struct diagnostics d = { .max = 2 };
	char *text = NULL;
	size_t size;
	FILE *to = open_memstream(&text, &size);

	(void)state;
	CHECK(to);
	for (unsigned i = 1; i <= 3; i++)
		diagnostics_add(&d, -EINVAL, NULL, i, "odd");
	diagnostics_print(&d, to, "temple.ini, ");
	fclose(to);
	CHECK(strcmp(text, "temple.ini, line 1: odd\ntemple.ini, line 2: odd\n"
			   "temple.ini, and 1 more\n") == 0);
	free(text);
	diagnostics_finish(&d);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(says_the_place_before_the_sentence),
		cmocka_unit_test(a_zeroed_list_keeps_the_cause_alone),
		cmocka_unit_test(an_error_is_the_cause_whatever_was_warned_of_before),
		cmocka_unit_test(warnings_that_fill_a_list_leave_room_for_an_error),
		cmocka_unit_test(no_list_takes_nothing),
		cmocka_unit_test(counts_what_does_not_fit),
		cmocka_unit_test(orders_by_lines_and_keeps_the_rest),
		cmocka_unit_test(replaces_what_cannot_be_printed),
		cmocka_unit_test(cuts_a_text_too_long_between_characters),
		cmocka_unit_test(prints_all_and_how_many_are_missing),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
