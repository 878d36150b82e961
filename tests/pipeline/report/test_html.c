/* Escaping, units and base64 of the report. */
#include <stdlib.h>
#include <string.h>

#include "pipeline/report/html.h"
#include "tests/check.h"

static char *text;
static size_t size;

static FILE *begin(void)
{
	free(text);
	text = NULL;
	return open_memstream(&text, &size);
}

static bool says(FILE *to, const char *expected)
{
	fclose(to);
	return strcmp(text, expected) == 0;
}

static void escapes_what_html_reserves(void **state)
{
	FILE *to = begin();

	(void)state;
	html_text(to, "<a href=\"x\">Bayon & l'Est\n</a>");
	CHECK(says(to, "&lt;a href=&quot;x&quot;&gt;Bayon &amp; l&#39;Est &lt;/a&gt;"));
}

static void groups_digits(void **state)
{
	static const struct {
		uint64_t count;
		const char *text;
	} cases[] = { { 0, "0" },
		      { 999, "999" },
		      { 1000, "1&#8239;000" },
		      { 12034005, "12&#8239;034&#8239;005" } };

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		FILE *to = begin();

		html_count(to, cases[i].count);
		CHECK(says(to, cases[i].text));
	}
}

static void chooses_units(void **state)
{
	FILE *to = begin();

	(void)state;
	html_bytes(to, 999);
	html_bytes(to, 1500);
	html_bytes(to, 12345678);
	CHECK(says(to, "999&#8239;B1.5&#8239;kB12&#8239;MB"));
	to = begin();
	html_length(to, 2.5);
	html_length(to, 0.25);
	html_length(to, 0.0125);
	html_length(to, 0.0005);
	html_length(to, 0);
	CHECK(says(to, "2.50&#8239;m25&#8239;cm12.5&#8239;mm0.500&#8239;mm0"));
	to = begin();
	html_time(to, 1234);
	html_time(to, 150000);
	html_time(to, 7200000);
	CHECK(says(to, "1.2&#8239;s2.5&#8239;min2.0&#8239;h"));
}

/* The vectors of RFC 4648, section 10. */
static void encodes_base64(void **state)
{
	static const char *const vectors[] = { "",         "Zg==",     "Zm8=",    "Zm9v",
					       "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy" };

	(void)state;
	for (size_t n = 0; n < ARRAY_COUNT(vectors); n++) {
		char expected[64];
		FILE *to = begin();

		html_data(to, "a/b", (struct bytes){ (const uint8_t *)"foobar", n });
		snprintf(expected, sizeof(expected), "data:a/b;base64,%s", vectors[n]);
		CHECK(says(to, expected));
	}
}

static void keeps_the_share_of_a_bar_within_its_cell(void **state)
{
	FILE *to = begin();

	(void)state;
	html_bar(to, 1.5);
	html_bar_end(to);
	html_bar(to, -1);
	CHECK(says(to, "<td class=\"bar\" style=\"--share:100.0%\"></td>"
		       "<td class=\"bar\" style=\"--share:0.0%\">"));
	free(text);
	text = NULL;
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(escapes_what_html_reserves),
		cmocka_unit_test(groups_digits),
		cmocka_unit_test(chooses_units),
		cmocka_unit_test(encodes_base64),
		cmocka_unit_test(keeps_the_share_of_a_bar_within_its_cell),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
