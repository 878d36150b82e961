/* A page's tags: what is kept of them, and that no tag has more than one attribute afterwards. */
#include "format/html_tags.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/check.h"

static struct buffer reduced;

static int reduce(const char *html, size_t size, struct html_tags *found)
{
	uint8_t *exact = malloc(size ? size : 1); /* no slack for the sanitizer */
	int rc;

	memcpy(exact, html, size);
	buffer_finish(&reduced);
	buffer_init(&reduced, HTML_TAGS_GROWTH * size + 64);
	rc = html_tags_reduce(&reduced, (struct bytes){ exact, size }, found);
	free(exact);
	return rc;
}

static void keeps_text_tags_and_two_attributes(void **state)
{
	static const struct {
		const char *html, *reduced;
	} cases[] = {
		{ "", "" },
		{ "a &amp; b", "a &amp; b" },
		{ "<p>a</p>", "<p>a</p>" },
		{ "<P class=x id='y' hidden>a</P >", "<P>a</P>" },
		{ "<br/><br /><hr>", "<br/><br/><hr>" },
		{ "<a href=part:x>b</a>", "<a href=\"part:x\">b</a>" },
		{ "<a class=c HREF = 'part:x' href=page:y>b</a>", "<a href=\"part:x\">b</a>" },
		{ "<img alt=\"a > b\" src=\"p.png\"/>", "<img src=\"p.png\"/>" },
		{ "<img src='a\"<b'>", "<img src=\"a&quot;&lt;b\">" },
		{ "<p href=x src=y>a", "<p>a" },
		{ "<!DOCTYPE html><!-- <p a b> --><?xml?>a<![CDATA[b]]>c", "ac" },
		{ "a<script>if (a<b) \"<p>\"</script>b<style>p{}</STYLE>c<script/>d", "abcd" },
		{ "1 < 2 <3 <", "1 &lt; 2 &lt;3 &lt;" },
		{ "</>a</ b>c", "ac" },
		{ "<p \"=' > a' b>c", "<p>c" },
		{ "<p a='", "<p>" },
		{ "<a href", "<a href=\"\">" },
		{ "<a href=", "<a href=\"\">" },
		{ "<!--", "" },
		{ "<script>x", "" },
		{ "<", "&lt;" },
	};
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		CHECK(reduce(cases[i].html, strlen(cases[i].html), NULL) == 0);
		if (reduced.size != strlen(cases[i].reduced) ||
		    (reduced.size && memcmp(reduced.data, cases[i].reduced, reduced.size) != 0))
			fail_msg("%s: '%.*s' instead of '%s'", cases[i].html, (int)reduced.size,
				 (const char *)reduced.data, cases[i].reduced);
	}
}

static void counts_the_attributes_of_the_fullest_tag(void **state)
{
	static const char html[] = "<p a>\n<p a=1 b='\n' c=\"d\" / e>\n<p a b>\n<br>";
	struct html_tags found;
	(void)state;

	CHECK(reduce(html, strlen(html), &found) == 0);
	CHECK(found.attribute_count == 4 && found.line == 2);
	CHECK(reduce("a", 1, &found) == 0 && found.attribute_count == 0);
}

/* Of every tag that is left: attributes, counted without regard to anything else. */
static void check_tags(void)
{
	const char *text = (const char *)reduced.data, *end = text + reduced.size;

	while (reduced.size && (text = memchr(text, '<', (size_t)(end - text)))) {
		const char *close = memchr(text, '>', (size_t)(end - text));
		const char *quote = memchr(text, '"', (size_t)(end - text));
		int quotes = 0;

		if (quote && close && quote < close) { /* > may stand in the value */
			const char *second = memchr(quote + 1, '"', (size_t)(end - quote - 1));

			CHECK(second);
			close = memchr(second, '>', (size_t)(end - second));
		}
		CHECK(close);
		for (const char *c = text + 1; c < close; c++) {
			quotes += *c == '"';
			CHECK(*c != '<' && (quotes == 1 || *c != '>'));
		}
		CHECK(quotes == 0 || quotes == 2);
		text = close + 1;
	}
}

static void leaves_one_attribute_of_a_megabyte(void **state)
{
	const size_t size = 1 << 20;
	char *html = malloc(size);
	struct html_tags found;
	size_t at = 0;
	int count = 0;
	(void)state;

	CHECK(html);
	for (at = (size_t)snprintf(html, size, "<p"); at < size - 20; count++)
		at += (size_t)snprintf(html + at, size - at, " a%d", count);
	at += (size_t)snprintf(html + at, size - at, ">x</p>");
	CHECK(reduce(html, at, &found) == 0);
	CHECK(found.attribute_count == (uint32_t)count && found.line == 1);
	CHECK(reduced.size == 8 && memcmp(reduced.data, "<p>x</p>", 8) == 0);
	free(html);
}

static void holds_for_any_text(void **state)
{
	static const char pieces[] = "<<<>>/\"'=!-? \naphrefimgsrcscriptstyle";
	uint32_t random = 1;
	char html[200];
	(void)state;

	for (int n = 0; n < 20000; n++) {
		size_t size = (size_t)n % sizeof(html);

		for (size_t i = 0; i < size; i++) {
			random = random * 1664525 + 1013904223;
			html[i] = random >> 28 == 0 ? (char)(random >> 20)
						    : pieces[(random >> 16) % (sizeof(pieces) - 1)];
		}
		CHECK(reduce(html, size, NULL) == 0);
		check_tags();
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(keeps_text_tags_and_two_attributes),
		cmocka_unit_test(counts_the_attributes_of_the_fullest_tag),
		cmocka_unit_test(leaves_one_attribute_of_a_megabyte),
		cmocka_unit_test(holds_for_any_text),
	};
	int failed = cmocka_run_group_tests(tests, NULL, NULL);

	buffer_finish(&reduced);
	return failed;
}
