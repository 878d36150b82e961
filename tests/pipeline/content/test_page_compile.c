/* HTML into an article: what is kept, what is dropped, and that nothing nasty gets further. */
#include "pipeline/content/page_compile.h"

#include <errno.h>
#include <glib.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "format/article.h"
#include "format/html_tags.h"
#include "tests/check.h"

static struct article_blocks article;

/* What is compiled is valid: it is decoded at once. */
static int compile(struct bytes html)
{
	struct buffer bytes;
	int rc;

	buffer_init(&bytes, ARTICLE_BYTES_MAX);
	rc = page_compile(&bytes, html);
	if (rc == 0)
		CHECK(article_decode(&article, buffer_bytes(&bytes)) == 0);
	buffer_finish(&bytes);
	return rc;
}

static int parse(const char *text)
{
	return compile((struct bytes){ (const uint8_t *)text, strlen(text) });
}

/* The blocks as "style:text" would be; texts only, joined by |. */
static bool reads(const char *source, const char *expected)
{
	char joined[1000] = "";
	size_t at = 0;
	int rc = parse(source);
	bool equal;

	for (uint32_t i = 0; rc == 0 && i < article.block_count; i++)
		at += (size_t)snprintf(joined + at, sizeof(joined) - at, "%s%s%s", i ? "|" : "",
				       article.blocks[i].marker ? article.blocks[i].marker : "",
				       article.blocks[i].text ? article.blocks[i].text : "--");
	equal = rc == 0 && strcmp(joined, expected) == 0;
	if (!equal)
		printf("%d: \"%s\" instead of \"%s\"\n", rc, joined, expected);
	article_finish(&article);
	return equal;
}

static void keeps_blocks_in_order(void **state)
{
	(void)state;
	CHECK(reads("<h1>A</h1>\n<p>b <em>c</em>\n d</p><hr><p>e<br>f</p>", "A|b c d|--|e\nf"));
	CHECK(reads("text<p>then</p>more", "text|then|more"));
	CHECK(reads("<ul><li>a<li>b<ol><li>c</li><li><p>d</p></li></ol></ul>", "•a|•b|1.c|2.d"));
	CHECK(reads("<figure><img src=pictures/x.jpg><figcaption>cap</figcaption></figure>",
		    "pictures/x.jpg|cap"));
	CHECK(reads("<table><tr><th>a<th>b</tr><tr><td>c<td><p>d</p><p>e</p></tr></table>",
		    "a|b|c|d|e"));
	CHECK(reads("<p>a</p><p> \n </p><div></div><p>b</p>", "a|b")); /* empty ones go */
	CHECK(reads("<p>&lt;&amp;&eacute;&#x1780;</p>", "<&éក"));
}

static void knows_white_space(void **state)
{
	(void)state;
	CHECK(reads("<p>  a \n\t b  </p>", "a b"));
	CHECK(reads("<p>日本\n語の塔</p>", "日本語の塔")); /* a line's end is no space here */
	CHECK(reads("<p>日本 語</p>", "日本 語"));         /* a written space is one */
	CHECK(reads("<p>tower\n塔</p>", "tower 塔"));
	CHECK(reads("<p>a <em> b</em></p>", "a b"));
}

static void drops_scripts_styles_and_foreign_links(void **state)
{
	(void)state;
	CHECK(reads("<head><title>t</title></head><script>alert('x')</script>"
		    "<style>p{}</style><p onclick=x>seen</p><!-- not -->",
		    "seen"));
	CHECK(parse("<p><a href=\"https://example.org\">out</a> <a href=\"part:gate\">in</a> "
		    "<a href='part:'>none</a></p>") == 0);
	CHECK(article.link_count == 1 && strcmp(article.links[0], "gate") == 0);
	CHECK(article.blocks[0].span_count == 1 && article.blocks[0].spans[0].link == 0);
	CHECK(article.blocks[0].spans[0].start == 4 && article.blocks[0].spans[0].end == 6);
	article_finish(&article);
}

static void marks_rows_columns_and_looks(void **state)
{
	(void)state;
	CHECK(parse("<table><tr><th>a</th><td></td><td>b</td></tr><tr><td>c</td></tr></table>"
		    "<blockquote>q</blockquote><p>x<strong>y<em>z</em></strong></p>") == 0);
	CHECK(article.block_count == 5);
	CHECK(article.blocks[0].row == 1 && article.blocks[0].heading_cell);
	CHECK(article.blocks[1].row == 1 && article.blocks[1].column == 2);
	CHECK(article.blocks[1].column_count == 3);
	CHECK(article.blocks[2].row == 2 && article.blocks[2].column_count == 1);
	CHECK(article.blocks[3].quote && article.blocks[3].style == ARTICLE_QUOTE);
	CHECK(article.blocks[4].span_count == 2);
	CHECK(article.blocks[4].spans[1].flags == (ARTICLE_STRONG | ARTICLE_EMPHASIS));
	article_finish(&article);
}

static void refuses_what_says_nothing(void **state)
{
	char *large = malloc(HTML_BYTES_MAX + 1);

	(void)state;
	CHECK(parse("") == -EBADMSG);
	CHECK(parse("   \n") == -EBADMSG);
	CHECK(parse("<script>x</script>") == -EBADMSG);
	CHECK(parse("<p>a\xff</p>") == -EBADMSG);
	CHECK(parse("<<<>>>&;&#;") == 0);
	article_finish(&article);
	memset(large, 'a', HTML_BYTES_MAX + 1);
	CHECK(compile((struct bytes){ (uint8_t *)large, HTML_BYTES_MAX + 1 }) == -EFBIG);
	free(large);
	article_finish(NULL);
}

/* ---- spans */

/* Every span holds text, lies in its block, and begins where the one before has ended or later. */
static bool spans_are_sound(void)
{
	for (uint32_t i = 0; i < article.block_count; i++) {
		const struct article_block *block = &article.blocks[i];
		uint32_t from = 0;

		for (uint32_t k = 0; k < block->span_count; k++) {
			const struct article_span *span = &block->spans[k];

			if (span->start < from || span->end <= span->start ||
			    span->end > strlen(block->text) ||
			    span->link >= (int)article.link_count)
				return false;
			from = span->end;
		}
	}
	return true;
}

static void a_break_at_the_end_leaves_no_span(void **state)
{
	static const char *const pages[] = {
		"<p>word<br><b><br></b></p>",
		"<p>word<b><br></b></p>",
		"<p>word<b> <br></b><i> </i></p>",
		"<p>word<br><a href=part:x><br></a><b><br></b>",
		"<p><b>word<br></b><br><i><br><br></i></p>",
	};
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(pages); i++) {
		CHECK(parse(pages[i]) == 0);
		if (article.block_count != 1 || strcmp(article.blocks[0].text, "word") != 0 ||
		    !spans_are_sound() || article.blocks[0].span_count > 1)
			fail_msg("%s: '%s', %u spans", pages[i], article.blocks[0].text,
				 article.blocks[0].span_count);
		article_finish(&article);
	}
}

/* Random pages of inline elements, empty ones too, breaks and white space, nested and side by side.
 */
static void spans_are_sound_on_any_page(void **state)
{
	static const char *const pieces[] = { "<b>",
					      "</b>",
					      "<i>",
					      "</i>",
					      "<a href=part:x>",
					      "</a>",
					      "<small>",
					      "</small>",
					      "<sup>",
					      "</sup>",
					      "<br>",
					      "<br>",
					      " ",
					      "\n",
					      "w",
					      "é",
					      "塔",
					      "<p>",
					      "</p>",
					      "<hr>",
					      "<li>",
					      "<td>",
					      "<span>",
					      "</span>",
					      "<img src=x>",
					      "<h1>",
					      "</h1>",
					      "<table><tr><th>",
					      "</table>" };
	uint32_t random = 1;
	char page[400];
	(void)state;

	for (int n = 0; n < 20000; n++) {
		size_t at = 0;

		for (int k = 0; k < 1 + n % 24; k++) {
			random = random * 1664525 + 1013904223;
			at += (size_t)snprintf(page + at, sizeof(page) - at, "%s",
					       pieces[(random >> 16) % ARRAY_COUNT(pieces)]);
		}
		if (parse(page) == 0) {
			if (!spans_are_sound())
				fail_msg("%s", page);
			article_finish(&article);
		}
	}
}

/* ---- what is large */

/* A second of the processor for what takes a hundredth: it once took as long as the square of it.
 */
static void many_attributes_take_no_time(void **state)
{
	char *page = malloc(HTML_BYTES_MAX);
	clock_t began = clock();
	size_t at = 0;
	(void)state;

	CHECK(page);
	for (int k = 0; at < HTML_BYTES_MAX - 40; k++)
		at += (size_t)snprintf(page + at, 20, k ? " a%d" : "<p", k);
	at += (size_t)snprintf(page + at, 20, ">x</p>");
	CHECK(compile((struct bytes){ (uint8_t *)page, at }) == 0);
	CHECK(article.block_count == 1 && strcmp(article.blocks[0].text, "x") == 0);
	CHECK(clock() - began < CLOCKS_PER_SEC);
	article_finish(&article);
	free(page);
}

/* Breaking lines of one endless paragraph takes as long as the square of it, too. */
static void an_endless_paragraph_becomes_several(void **state)
{
	static const char *const words[] = { "a", "word ", "é", "ក", "<br>x", "<b>塔</b>" };
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(words); i++) {
		size_t size = strlen(words[i]), text_bytes = 0;
		char *page = malloc(100000);

		CHECK(page);
		for (size_t at = 0; at < 100000 - size; at += size)
			memcpy(page + at, words[i], size);
		CHECK(compile((struct bytes){ (uint8_t *)page, 100000 / size * size - size }) == 0);
		CHECK(article.block_count > 1 && spans_are_sound());
		for (uint32_t k = 0; k < article.block_count; k++) {
			CHECK(strlen(article.blocks[k].text) <= ARTICLE_TEXT_BYTES_MAX);
			CHECK(g_utf8_validate(article.blocks[k].text, -1, NULL));
			text_bytes += strlen(article.blocks[k].text);
		}
		if (i == 0)
			CHECK(text_bytes == 99999); /* nothing is lost */
		article_finish(&article);
		free(page);
	}
}

/* Deep, wide, unclosed, many: in bounded time and memory, without a crash. */
static void survives_nasty_pages(void **state)
{
	static const char *const pieces[] = { "<div>",     "<ul><li>",     "<table><tr><td>",
					      "<b>",       "<blockquote>", "<p>x",
					      "<ol><li>a", "<td>",         "<a href=part:x>",
					      "</p></ul>", "<br>",         "<li>" };
	struct buffer page;

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(pieces); i++) {
		buffer_init(&page, HTML_BYTES_MAX);
		for (int k = 0; k < 4000; k++)
			buffer_put(&page, pieces[i], strlen(pieces[i]));
		buffer_put(&page, "end", 3);
		if (compile(buffer_bytes(&page)) == 0) {
			CHECK(article.block_count > 0 && article.block_count <= ARTICLE_BLOCKS_MAX);
			article_finish(&article);
		}
		buffer_finish(&page);
	}
}

static void links_lead_to_parts_pages_and_tours(void **state)
{
	(void)state;
	CHECK(parse("<p><a href=\"page:gate\">a</a> <a href=\"part:naga\">b</a>"
		    "<a href=\"tour:x\">c</a><a href=\"tour:\">d</a><a href=\"mail:x\">e</a></p>") ==
	      0);
	CHECK(article.link_count == 3 && strcmp(article.links[2], "tour:x") == 0);
	CHECK(strcmp(article.links[0], "gate") == 0);
	CHECK(strcmp(article.links[1], "naga") == 0);
	article_finish(&article);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(links_lead_to_parts_pages_and_tours),
		cmocka_unit_test(keeps_blocks_in_order),
		cmocka_unit_test(knows_white_space),
		cmocka_unit_test(drops_scripts_styles_and_foreign_links),
		cmocka_unit_test(marks_rows_columns_and_looks),
		cmocka_unit_test(refuses_what_says_nothing),
		cmocka_unit_test(a_break_at_the_end_leaves_no_span),
		cmocka_unit_test(spans_are_sound_on_any_page),
		cmocka_unit_test(many_attributes_take_no_time),
		cmocka_unit_test(an_endless_paragraph_becomes_several),
		cmocka_unit_test(survives_nasty_pages),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
