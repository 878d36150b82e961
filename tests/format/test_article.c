/* Articles on the wire: what comes back is what went in, and nothing else is taken. */
#include "format/article.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "format/article_builder.h"
#include "tests/check.h"

/* ---- an article with everything in it */

static const struct article_span spans[] = { { 0, 3, ARTICLE_STRONG, -1 },
					     { 4, 7, 0, 0 },
					     { 7, 9, ARTICLE_FLAGS, 1 } };

static struct article_block blocks[] = {
	{ .kind = ARTICLE_TEXT, .style = ARTICLE_HEADING_1, .text = "A" },
	{ .kind = ARTICLE_TEXT, .text = "塔 and\nx", .spans = spans, .span_count = 3 },
	{ .kind = ARTICLE_IMAGE, .style = ARTICLE_FIGURE, .text = "pictures/a.png" },
	{ .kind = ARTICLE_RULE, .marker = "•", .indent = 2 },
	{ .kind = ARTICLE_TEXT, .text = "item", .marker = "12.", .indent = 1, .quote = true },
	{ .kind = ARTICLE_TEXT,
	  .style = ARTICLE_CELL,
	  .text = "h",
	  .row = 1,
	  .column = 1,
	  .column_count = 3,
	  .heading_cell = true },
	{ .kind = ARTICLE_TEXT,
	  .style = ARTICLE_CELL,
	  .text = "c",
	  .row = 1,
	  .column = 1,
	  .column_count = 3 },
	{ .kind = ARTICLE_TEXT, .style = ARTICLE_CELL, .text = "d", .row = 3, .column_count = 1 },
};

static const char *links[] = { "gate", "tour:round" };

static const struct article_blocks example = { blocks, ARRAY_COUNT(blocks), links, 2 };

static struct buffer encoded(const struct article_blocks *article)
{
	struct buffer out;

	buffer_init(&out, ARTICLE_BYTES_MAX);
	CHECK(article_encode(&out, article) == 0);
	return out;
}

static bool is_same(const char *a, const char *b)
{
	return a == b || (a && b && strcmp(a, b) == 0);
}

static void comes_back_as_it_went(void **state)
{
	struct buffer bytes = encoded(&example), again;
	struct article_blocks back;
	(void)state;

	CHECK(article_decode(&back, buffer_bytes(&bytes)) == 0);
	CHECK(back.block_count == example.block_count && back.link_count == 2);
	CHECK(is_same(back.links[0], "gate") && is_same(back.links[1], "tour:round"));
	for (uint32_t i = 0; i < back.block_count; i++) {
		const struct article_block *is = &back.blocks[i], *was = &blocks[i];

		CHECK(is->kind == was->kind && is->style == was->style);
		CHECK(is_same(is->text, was->text) && is_same(is->marker, was->marker));
		CHECK(is->indent == was->indent && is->quote == was->quote);
		CHECK(is->row == was->row && is->column == was->column);
		CHECK(is->column_count == was->column_count);
		CHECK(is->heading_cell == was->heading_cell);
		CHECK(is->span_count == was->span_count);
		for (uint32_t k = 0; k < is->span_count; k++)
			CHECK(memcmp(&is->spans[k], &was->spans[k], sizeof(*spans)) == 0);
	}
	again = encoded(&back);
	CHECK(again.size == bytes.size && memcmp(again.data, bytes.data, bytes.size) == 0);
	article_finish(&back);
	article_finish(NULL);
	buffer_finish(&again);
	buffer_finish(&bytes);
}

/* docs/article.md, byte by byte. */
static void bytes_are_as_the_page_of_the_format_says(void **state)
{
	static const struct article_span span = { 1, 3, ARTICLE_SMALL | ARTICLE_SUPERSCRIPT, 0 };
	static struct article_block of[] = { { .kind = ARTICLE_TEXT,
					       .style = ARTICLE_CELL,
					       .text = "aé",
					       .marker = "1.",
					       .indent = 2,
					       .quote = true,
					       .row = 258,
					       .column = 1,
					       .column_count = 3,
					       .heading_cell = true,
					       .spans = &span,
					       .span_count = 1 } };
	static const uint8_t expected[] = {
		'G', 'P', 'a', 'r', 1, 0,   1,    0,    1, 0,   1,   0, 12, 0, 0, 0, /* the block */
		0,   6,   7,   2,   2, 1,   1,    3,    1, 0,                        /* the span */
		1,   0,   3,   0,   1, 0,   20,   0,                                 /* the texts */
		'g', 'a', 't', 'e', 0, 'a', 0xc3, 0xa9, 0, '1', '.', 0
	};
	const struct article_blocks article = { of, 1, links, 1 };
	struct buffer bytes = encoded(&article);
	struct article_blocks back;
	(void)state;

	CHECK(bytes.size == sizeof(expected));
	CHECK(memcmp(bytes.data, expected, sizeof(expected)) == 0);
	CHECK(article_decode(&back, buffer_bytes(&bytes)) == 0);
	article_finish(&back);
	buffer_finish(&bytes);
}

static void refuses_every_truncation(void **state)
{
	struct buffer bytes = encoded(&example);
	struct article_blocks back;
	(void)state;

	for (size_t n = 0; n < bytes.size; n++) {
		uint8_t *exact = malloc(n ? n : 1); /* no slack for the sanitizer */

		memcpy(exact, bytes.data, n);
		CHECK(article_decode(&back, (struct bytes){ exact, n }) == -EBADMSG);
		CHECK(back.blocks == NULL && back.block_count == 0);
		free(exact);
	}
	buffer_put_u8(&bytes, 0);
	CHECK(article_decode(&back, buffer_bytes(&bytes)) == -EBADMSG);
	buffer_finish(&bytes);
}

/* Either refused, or another article that is as good: its bytes are these. */
static void takes_no_byte_that_it_would_not_write(void **state)
{
	struct buffer bytes = encoded(&example);
	uint32_t refused = 0;
	(void)state;

	for (size_t i = 0; i < bytes.size; i++) {
		const uint8_t was = bytes.data[i];

		for (int value = 0; value < 256; value++) {
			struct article_blocks back;
			struct buffer again;

			bytes.data[i] = (uint8_t)value;
			if (article_decode(&back, buffer_bytes(&bytes)) < 0) {
				refused++;
				continue;
			}
			again = encoded(&back);
			CHECK(again.size == bytes.size);
			CHECK(memcmp(again.data, bytes.data, bytes.size) == 0);
			article_finish(&back);
			buffer_finish(&again);
		}
		bytes.data[i] = was;
	}
	CHECK(refused > 200 * 100); /* almost any other value of head, blocks and spans */
	buffer_finish(&bytes);
}

/* ---- what is no article */

static int decode(const struct article_blocks *article)
{
	struct buffer bytes = encoded(article);
	struct article_blocks back;
	const int rc = article_decode(&back, buffer_bytes(&bytes));

	article_finish(&back);
	buffer_finish(&bytes);
	return rc;
}

#define CELL(r, c, n)                                                                              \
	{                                                                                          \
		.text = "x", .row = r, .column = c, .column_count = n                              \
	}
#define SPAN(...)                                                                                  \
	{                                                                                          \
		.text = "aéz", .spans = (const struct article_span[]){ __VA_ARGS__ },              \
		.span_count = sizeof((const struct article_span[]){ __VA_ARGS__ }) /               \
			      sizeof(struct article_span)                                          \
	}

static void refuses_what_contradicts_itself(void **state)
{
	const struct {
		const char *what;
		struct article_block blocks[3];
		uint32_t count;
		bool is_valid;
	} cases[] = {
		{ "no block", { { 0 } }, 0, false },
		{ "a text", { { .text = "x" } }, 1, true },
		{ "an empty text", { { .text = "" } }, 1, false },
		{ "an empty marker", { { .text = "x", .marker = "" } }, 1, false },
		{ "no UTF-8", { { .text = "x\xff" } }, 1, false },
		{ "half a character", { { .text = "x\xc3" } }, 1, false },
		{ "another kind", { { .kind = 3, .text = "x" } }, 1, false },
		{ "another style", { { .style = ARTICLE_STYLE_COUNT, .text = "x" } }, 1, false },
		{ "a rule with a text", { { .kind = ARTICLE_RULE, .text = "x" } }, 1, false },
		{ "a picture without a name", { { .kind = ARTICLE_IMAGE } }, 1, false },
		{ "a marker of 15 bytes",
		  { { .text = "x", .marker = "123456789012345" } },
		  1,
		  true },
		{ "a marker of 16", { { .text = "x", .marker = "1234567890123456" } }, 1, false },

		{ "a span", { SPAN({ 1, 3, 1, -1 }) }, 1, true },
		{ "spans side by side", { SPAN({ 0, 1, 1, -1 }, { 1, 3, 2, -1 }) }, 1, true },
		{ "spans that overlap", { SPAN({ 0, 3, 1, -1 }, { 1, 4, 2, -1 }) }, 1, false },
		{ "spans in no order", { SPAN({ 3, 4, 1, -1 }, { 0, 1, 2, -1 }) }, 1, false },
		{ "an empty span", { SPAN({ 1, 1, 1, -1 }) }, 1, false },
		{ "a span backwards", { SPAN({ 3, 1, 1, -1 }) }, 1, false },
		{ "a span beyond the text", { SPAN({ 0, 5, 1, -1 }) }, 1, false },
		{ "a span from half a character", { SPAN({ 2, 4, 1, -1 }) }, 1, false },
		{ "a span to half a character", { SPAN({ 0, 2, 1, -1 }) }, 1, false },
		{ "a span of no look", { SPAN({ 0, 1, 0, -1 }) }, 1, false },
		{ "another flag", { SPAN({ 0, 1, 32, -1 }) }, 1, false },
		{ "the last link", { SPAN({ 0, 1, 0, 1 }) }, 1, true },
		{ "another link", { SPAN({ 0, 1, 0, 2 }) }, 1, false },
		{ "a span of a picture",
		  { { .kind = ARTICLE_IMAGE,
		      .text = "x",
		      .spans = (const struct article_span[]){ { 0, 1, 1, -1 } },
		      .span_count = 1 } },
		  1,
		  false },

		{ "two cells", { CELL(1, 0, 2), CELL(1, 1, 2) }, 2, true },
		{ "two blocks of a cell", { CELL(1, 1, 2), CELL(1, 1, 2) }, 2, true },
		{ "cells backwards", { CELL(1, 1, 2), CELL(1, 0, 2) }, 2, false },
		{ "a cell outside its row", { CELL(1, 2, 2) }, 1, false },
		{ "8 columns", { CELL(1, 7, 8) }, 1, true },
		{ "9 columns", { CELL(1, 7, 9) }, 1, false },
		{ "a row of two widths", { CELL(1, 0, 2), CELL(1, 1, 3) }, 2, false },
		{ "rows forwards", { CELL(1, 0, 1), CELL(2, 0, 1), CELL(9, 0, 1) }, 3, true },
		{ "rows backwards", { CELL(2, 0, 1), CELL(1, 0, 1) }, 2, false },
		{ "a row in two pieces",
		  { CELL(1, 0, 2), { .text = "x" }, CELL(1, 1, 2) },
		  3,
		  false },
		{ "a column without a row", { CELL(0, 1, 0) }, 1, false },
		{ "columns without a row", { CELL(0, 0, 1) }, 1, false },
		{ "a heading cell without a row",
		  { { .text = "x", .heading_cell = true } },
		  1,
		  false },
	};
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		const struct article_blocks article = { (struct article_block *)cases[i].blocks,
							cases[i].count, links, 2 };

		if (decode(&article) != (cases[i].is_valid ? 0 : -EBADMSG))
			fail_msg("%s", cases[i].what);
	}
}

static void takes_what_is_largest_and_no_more(void **state)
{
	struct article_block *many = calloc(ARTICLE_BLOCKS_MAX + 1, sizeof(*many));
	char *text = malloc(ARTICLE_TEXT_BYTES_MAX + 2);
	struct article_blocks article = { many, ARTICLE_BLOCKS_MAX, links, 2 };
	const char *long_link[] = { text };
	(void)state;

	for (uint32_t i = 0; i <= ARTICLE_BLOCKS_MAX; i++)
		many[i] = (struct article_block){ .text = "x" };
	CHECK(decode(&article) == 0);
	article.block_count++;
	CHECK(decode(&article) == -EBADMSG);

	memset(text, 'a', ARTICLE_TEXT_BYTES_MAX + 1);
	text[ARTICLE_TEXT_BYTES_MAX + 1] = '\0';
	article = (struct article_blocks){ many, 1, long_link, 1 };
	CHECK(decode(&article) == -EBADMSG);
	many[0].text = text;
	article.link_count = 0;
	CHECK(decode(&article) == -EBADMSG);
	text[ARTICLE_TEXT_BYTES_MAX] = '\0';
	CHECK(decode(&article) == 0);
	free(text);
	free(many);
}

/* ---- the builder */

static const struct article_look body = { .link = -1 };

static void a_builder_keeps_its_first_failure(void **state)
{
	struct article_builder builder;
	struct buffer out;
	(void)state;

	buffer_init(&out, ARTICLE_BYTES_MAX);
	article_builder_init(&builder);
	CHECK(article_builder_encode(&builder, &out) == -EBADMSG); /* says nothing */
	article_builder_finish(&builder);
	article_builder_init(&builder);
	for (int i = 0; i <= ARTICLE_BLOCKS_MAX; i++)
		article_builder_rule(&builder, &body);
	CHECK(article_builder_error(&builder) == -EFBIG);
	article_builder_text(&builder, "x", 1, &body);
	article_builder_image(&builder, "x", &body);
	CHECK(article_builder_link(&builder, "x") == -1);
	CHECK(article_builder_encode(&builder, &out) == -EFBIG && out.size == 0);
	article_builder_finish(&builder);
	buffer_finish(&out);
}

static void a_builder_leaves_out_what_no_article_may_have(void **state)
{
	char *name = malloc(ARTICLE_TEXT_BYTES_MAX + 2);
	struct article_builder builder;
	struct article_blocks back;
	struct buffer out;
	(void)state;

	memset(name, 'a', ARTICLE_TEXT_BYTES_MAX + 1);
	name[ARTICLE_TEXT_BYTES_MAX + 1] = '\0';
	buffer_init(&out, ARTICLE_BYTES_MAX);
	article_builder_init(&builder);
	article_builder_image(&builder, "", &body);
	article_builder_image(&builder, name, &body);
	CHECK(article_builder_link(&builder, "") == -1);
	CHECK(article_builder_link(&builder, name) == -1);
	CHECK(article_builder_count(&builder) == 0);
	article_builder_marker(&builder, "1234567890123456789");
	article_builder_text(&builder, " a \n", 4, &body);
	article_builder_text(&builder, "b ", 2, &body);
	article_builder_break(&builder, &body);
	CHECK(article_builder_encode(&builder, &out) == 0);
	CHECK(article_decode(&back, buffer_bytes(&out)) == 0 && back.block_count == 1);
	CHECK(is_same(back.blocks[0].text, "a b"));
	CHECK(is_same(back.blocks[0].marker, "123456789012345"));
	article_finish(&back);
	article_builder_finish(&builder);
	buffer_finish(&out);
	free(name);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(comes_back_as_it_went),
		cmocka_unit_test(bytes_are_as_the_page_of_the_format_says),
		cmocka_unit_test(refuses_every_truncation),
		cmocka_unit_test(takes_no_byte_that_it_would_not_write),
		cmocka_unit_test(refuses_what_contradicts_itself),
		cmocka_unit_test(takes_what_is_largest_and_no_more),
		cmocka_unit_test(a_builder_keeps_its_first_failure),
		cmocka_unit_test(a_builder_leaves_out_what_no_article_may_have),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
