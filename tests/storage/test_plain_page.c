/* Pages of old releases: what is left of their HTML, and that any bytes give a valid article or
 * none. */
#include "storage/plain_page.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "format/article.h"
#include "format/html_tags.h"
#include "tests/check.h"

static struct article_blocks article;

static int make(const char *html, size_t size)
{
	uint8_t *exact = malloc(size ? size : 1); /* no slack for the sanitizer */
	struct buffer out;
	int rc;

	memcpy(exact, html, size);
	buffer_init(&out, ARTICLE_BYTES_MAX);
	rc = plain_page(&out, (struct bytes){ exact, size });
	if (rc == 0)
		CHECK(article_decode(&article, buffer_bytes(&out)) == 0);
	buffer_finish(&out);
	free(exact);
	return rc;
}

/* The article as text: a letter for the style of each block, its marker, its text. */
static const char *read_as(const char *html)
{
	static const char styles[] = "p123qfc";
	static char text[1000];
	size_t at = 0;

	if (make(html, strlen(html)) < 0)
		return "none";
	for (uint32_t i = 0; i < article.block_count; i++) {
		const struct article_block *block = &article.blocks[i];
		const char kind = block->kind == ARTICLE_IMAGE  ? '#'
				  : block->kind == ARTICLE_RULE ? '-'
								: styles[block->style];

		at += (size_t)snprintf(
			text + at, sizeof(text) - at, "%s%c%s%s%s", i ? "|" : "", kind,
			block->quote    ? ">"
			: block->indent ? ">>"
					: "",
			block->marker ? block->marker : "", block->text ? block->text : "");
		CHECK(block->span_count == 0);
	}
	article_finish(&article);
	return text;
}

static void keeps_paragraphs_headings_and_pictures(void **state)
{
	static const struct {
		const char *html, *article;
	} cases[] = {
		{ "<h1>A</h1>\n<p>b <em>c</em>\n d</p><hr><p>e<br>f</p>", "1A|pb c d|-|pe\nf" },
		{ "text<p>then</p>more", "ptext|pthen|pmore" },
		{ "<h2>a</h2><h3>b</h3><h4>c</h4>d", "2a|3b|3c|pd" },
		{ "<figure><img src=pictures/x.jpg><figcaption>cap</figcaption></figure>after",
		  "#pictures/x.jpg|fcap|pafter" },
		{ "<blockquote><p>a</p><p>b</p></blockquote><p>c</p>", "q>a|q>b|pc" },
		{ "<ul><li>a<li>b<ol><li>c</li></ol></li></ul>d", "p>>•a|p>>•b|p>>•c|pd" },
		{ "<table><caption>t</caption><tr><th>a<td>b</tr><tr><td>c</table>d",
		  "ft|pa|pb|pc|pd" },
		{ "<html><head><meta charset=x><title>t</title></head><body>a</body></html>",
		  "pa" },
		{ "<style>p{}</style><p>a<script>b</script>c</p><!-- d -->", "pac" },
		{ "<p>see <a href=\"part:gate\">the <b>gate</b></a>.", "psee the gate." },
		{ "<P CLASS=x>a</P><IMG SRC='pictures/&amp;.png'>", "pa|#pictures/&.png" },
		{ "<p>日本\n語の塔</p>", "p日本語の塔" },
		{ "", "none" },
		{ " <p> </p>\n<img>", "none" },
		{ "<title>a</title>", "none" },
		{ "<p>\xff</p>", "none" },
	};
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(cases); i++)
		if (strcmp(read_as(cases[i].html), cases[i].article) != 0)
			fail_msg("%s: %s", cases[i].html, read_as(cases[i].html));
}

static void replaces_entities(void **state)
{
	static const struct {
		const char *html, *article;
	} cases[] = {
		{ "&lt;p&gt; &amp;amp; &quot;", "p<p> &amp; \"" },
		{ "caf&eacute; &Agrave; &yuml;&nbsp;&copy;", "pcafé À ÿ\u00a0©" },
		{ "&ldquo;a&rdquo;&mdash;b&hellip; 5&euro; c&oelig;ur", "p“a”—b… 5€ cœur" },
		{ "&#233;&#x1780;&#X41;", "péកA" },
		{ "&#0;&#xd800;&#x110000;&#-1;&#;&;&", "p&#0;&#xd800;&#x110000;&#-1;&#;&;&" },
		{ "&unknown; &eacute AT&T;", "p&unknown; &eacute AT&T;" },
		{ "a&#32;&#10;b", "pa b" },
	};
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(cases); i++)
		if (strcmp(read_as(cases[i].html), cases[i].article) != 0)
			fail_msg("%s: %s", cases[i].html, read_as(cases[i].html));
}

static void refuses_what_is_too_large(void **state)
{
	char *page = malloc(HTML_BYTES_MAX + 1);
	(void)state;

	memset(page, 'a', HTML_BYTES_MAX + 1);
	CHECK(make(page, HTML_BYTES_MAX) == 0);
	CHECK(article.block_count > 1); /* no block is longer than the layout can bear */
	article_finish(&article);
	CHECK(make(page, HTML_BYTES_MAX + 1) == -EBADMSG);
	for (size_t i = 0; i + 4 <= HTML_BYTES_MAX; i += 4)
		memcpy(page + i, "<hr>", 4);
	CHECK(make(page, HTML_BYTES_MAX) == -EBADMSG); /* too many blocks */
	free(page);
}

static void any_text_gives_a_valid_article_or_none(void **state)
{
	static const char *const pieces[] = {
		"<p>",
		"</p>",
		"<li>",
		"<ul>",
		"</ul>",
		"<img src=\"x\">",
		"<img src='&amp;\">'>",
		"<br>",
		"<h1>",
		"</h1>",
		"<hr>",
		"<title>",
		"</title>",
		"<blockquote>",
		"word",
		" ",
		"\n",
		"&amp;",
		"&",
		"&#x",
		";",
		"<",
		">",
		"\"",
		"塔",
		"<td>",
		"</blockquote>",
		"<figure>",
		"<!--",
		"<script>",
		"/",
	};
	uint32_t random = 1, made = 0;
	char page[600];
	(void)state;

	for (int n = 0; n < 8000; n++) {
		size_t at = 0;

		for (int k = 0; k < 1 + n % 24; k++) {
			random = random * 1664525 + 1013904223;
			at += (size_t)snprintf(page + at, sizeof(page) - at, "%s",
					       pieces[(random >> 16) % ARRAY_COUNT(pieces)]);
		}
		if (make(page, at) == 0) {
			made++;
			article_finish(&article);
		}
	}
	CHECK(made > 4000);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(keeps_paragraphs_headings_and_pictures),
		cmocka_unit_test(replaces_entities),
		cmocka_unit_test(refuses_what_is_too_large),
		cmocka_unit_test(any_text_gives_a_valid_article_or_none),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
