#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/metrics.h"
#include "tests/check.h"

static struct buffer out;

static int begin(void **state)
{
	(void)state;
	buffer_init(&out, METRICS_BYTES_MAX);
	return 0;
}

static int end(void **state)
{
	(void)state;
	buffer_finish(&out);
	return 0;
}

static struct bytes text(const char *string)
{
	return (struct bytes){ (const uint8_t *)string, strlen(string) };
}

static bool is(const char *expected)
{
	return out.size == strlen(expected) && memcmp(out.data, expected, out.size) == 0;
}

static void a_figure_is_three_lines_of_the_format(void **state)
{
	(void)state;
	metrics_gauge(&out, "a_seconds", "How long.", 0.25);
	metrics_counter(&out, "a_bytes_total", "How much.", 123456789012.0);
	CHECK(is("# HELP a_seconds How long.\n# TYPE a_seconds gauge\na_seconds 0.25\n"
		 "# HELP a_bytes_total How much.\n# TYPE a_bytes_total counter\n"
		 "a_bytes_total 123456789012\n"));
}

static void labels_are_escaped_and_what_is_no_text_is_replaced(void **state)
{
	const struct figure_label labels[] = { { "name", "a \"b\" \\ \n c" },
					       { "other", "ប្រាសាទ \xff\xc0\x80" } };
	char value[64];

	(void)state;
	metrics_info(&out, "a_info", "Words.", labels, 2);
	CHECK(is("# HELP a_info Words.\n# TYPE a_info gauge\n"
		 "a_info{name=\"a \\\"b\\\" \\\\ ? c\",other=\"ប្រាសាទ ???\"} 1\n"));
	CHECK(metrics_valid(buffer_bytes(&out), "a_"));
	CHECK(metrics_label(buffer_bytes(&out), "a_info", "name", value, sizeof(value)));
	CHECK(strcmp(value, "a \"b\" \\ ? c") == 0);
	CHECK(metrics_label(buffer_bytes(&out), "a_info", "other", value, 4));
	CHECK(strcmp(value, "ប") == 0);
	CHECK(!metrics_label(buffer_bytes(&out), "a_info", "third", value, sizeof(value)));
	CHECK(value[0] == '\0');
}

static void metrics_are_found_by_their_whole_name(void **state)
{
	double value = -1;

	(void)state;
	CHECK(metrics_find(text("ab 1\nb 2.5\n"), "b", &value) && value == 2.5);
	CHECK(!metrics_find(text("ab 1\nabc 2\n"), "b", &value) && value == 2.5);
	CHECK(metrics_find(text("nonsense\nb -3e2\n"), "b", &value) && value == -300);
	CHECK(!metrics_find(text("b 1"), "b", &value)); /* a line that was cut */
	CHECK(!metrics_find(text(""), "b", &value));
}

static void only_whole_lines_about_the_programs_own_figures_are_valid(void **state)
{
	static const char *const bad[] = {
		"",
		"# HELP a_x Only words.\n",
		"a_x 1",
		"a_x\n",
		"a_x  1\n",
		"a_x 1 \n",
		"a_x 1 1700000000\n",
		"a_x one\n",
		"a_x +1\n",
		"a_x NaN\n",
		"a_x inf\n",
		"a_x 1e999\n",
		"a_x 0000000000000000000000000000000000000000000001\n",
		"a_x{} 1\n",
		"a_x{l} 1\n",
		"a_x{l=v} 1\n",
		"a_x{l=\"v} 1\n",
		"a_x{l=\"v\"\n",
		"a_x{l=\"v\\t\"} 1\n",
		"a_x{l=\"v\\\n",
		"a_x{l=\"\xff\"} 1\n",
		"a_x{l=\"v\",} 1\n",
		"a_x{l=\"v\"}1\n",
		"9a_x 1\n",
		"b_x 1\n",
		"a_ 1\n",
		"a_x 1\nb_x 1\n",
		"a_x 1\n\n",
		"a_x 1\n# nonsense\n",
		"# HELP b_x Other.\na_x 1\n",
		"# HELP a_x \x01\na_x 1\n",
		"# HELP a_x\na_x 1\n",
		"# TYPE a_x histogram\na_x 1\n",
		"# TYPE b_x gauge\na_x 1\n",
		"# TYPE a_x gauge \na_x 1\n",
		"<script>\n",
	};

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(bad); i++)
		if (metrics_valid(text(bad[i]), "a_"))
			fail_msg("held for valid: %s", bad[i]);
	CHECK(metrics_valid(text("a_x 1\n"), "a_"));
	CHECK(metrics_valid(text("# HELP a_x Words: {1}\n# TYPE a_x counter\na_x 0\n"), "a_"));
	CHECK(metrics_valid(text("a_x{l=\"\",m=\"\\\\\\\"\\n\"} -1.5e-3\n"), "a_"));
}

static void no_truncation_of_a_valid_text_reads_past_its_end(void **state)
{
	const char *whole = "# TYPE a_x gauge\na_x{l=\"ប\\\\\",m=\"n\"} 12\n";
	char value[8];

	(void)state;
	for (size_t n = 0; n <= strlen(whole); n++) {
		char *exact = malloc(n ? n : 1);
		const struct bytes cut = { (uint8_t *)exact, n };

		memcpy(exact, whole, n);
		CHECK(metrics_valid(cut, "a_") == (n == strlen(whole)));
		CHECK(metrics_label(cut, "a_x", "m", value, sizeof(value)) == (n == strlen(whole)));
		free(exact);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(a_figure_is_three_lines_of_the_format, begin, end),
		cmocka_unit_test_setup_teardown(labels_are_escaped_and_what_is_no_text_is_replaced,
						begin, end),
		cmocka_unit_test(metrics_are_found_by_their_whole_name),
		cmocka_unit_test(only_whole_lines_about_the_programs_own_figures_are_valid),
		cmocka_unit_test(no_truncation_of_a_valid_text_reads_past_its_end),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
