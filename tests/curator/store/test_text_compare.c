#include "curator/store/text_compare.h"

#include <errno.h>
#include <string.h>

#include "tests/check.h"

static struct bytes text(const char *string)
{
	return (struct bytes){ (const uint8_t *)string, strlen(string) };
}

static bool holds(const struct buffer *buffer, const char *string)
{
	return memmem(buffer->data, buffer->size, string, strlen(string)) != NULL;
}

static void changes_of_different_lines_are_merged(void **state)
{
	struct buffer out;
	bool is_clean = false;

	(void)state;
	buffer_init(&out, 1000);
	CHECK(text_merge(&out, text("a\nb\nc\nd\n"), text("A\nb\nc\nd\n"), text("a\nb\nc\nD\n"),
			 &is_clean) == 0);
	CHECK(is_clean && out.size == 8 && memcmp(out.data, "A\nb\nc\nD\n", 8) == 0);
	buffer_finish(&out);
}

static void where_both_changed_a_line_both_texts_stay(void **state)
{
	struct buffer out;
	bool is_clean = true;

	(void)state;
	buffer_init(&out, 1000);
	CHECK(text_merge(&out, text("a\nb\nc\n"), text("a\nours\nc\n"), text("a\nothers\nc\n"),
			 &is_clean) == 0);
	CHECK(!is_clean);
	CHECK(holds(&out, "<<<<<<< mine\nours\n=======\nothers\n>>>>>>> theirs\n"));
	buffer_finish(&out);
}

static void a_difference_shows_each_line_with_its_sign(void **state)
{
	struct buffer out;

	(void)state;
	buffer_init(&out, 1000);
	CHECK(text_difference(&out, text("a\nb\nc"), text("a\nB\nc")) == 0);
	CHECK(out.size == 12 && memcmp(out.data, " a\n-b\n+B\n c\n", 12) == 0);
	buffer_clear(&out);
	CHECK(text_difference(&out, text("same\n"), text("same\n")) == 0 && out.size == 0);
	CHECK(text_difference(&out, text(""), text("new\n")) == 0 && holds(&out, "+new\n"));
	buffer_finish(&out);
}

static void what_is_not_text_is_refused(void **state)
{
	const struct bytes picture = { (const uint8_t *)"\x89PNG\0\0", 6 };
	struct buffer out;
	bool is_clean;

	(void)state;
	buffer_init(&out, 1000);
	CHECK(text_merge(&out, text(""), picture, text(""), &is_clean) == -EINVAL);
	CHECK(text_difference(&out, text(""), picture) == -EINVAL);
	buffer_finish(&out);
}

static void a_result_that_does_not_fit_is_refused(void **state)
{
	struct buffer out;
	bool is_clean;

	(void)state;
	buffer_init(&out, 3);
	CHECK(text_merge(&out, text("a\n"), text("abcd\n"), text("a\n"), &is_clean) == -EFBIG);
	buffer_clear(&out);
	CHECK(text_difference(&out, text("a\n"), text("abcd\n")) == -EFBIG);
	buffer_finish(&out);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(changes_of_different_lines_are_merged),
		cmocka_unit_test(where_both_changed_a_line_both_texts_stay),
		cmocka_unit_test(a_difference_shows_each_line_with_its_sign),
		cmocka_unit_test(what_is_not_text_is_refused),
		cmocka_unit_test(a_result_that_does_not_fit_is_refused),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
