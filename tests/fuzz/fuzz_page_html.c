/* Any bytes as a page: parsed and laid out, its invariants checked. Drawing is left to the tests of
 * ui, it is slow and sees only what the layout made. */
#include <stdlib.h>
#include <string.h>

#include "ui/article.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check(const struct html *html)
{
	for (uint32_t i = 0; i < html->block_count; i++) {
		const struct html_block *block = &html->blocks[i];
		uint32_t length = block->text ? (uint32_t)strlen(block->text) : 0;

		if ((block->kind == HTML_RULE) != (block->text == NULL))
			abort();
		for (uint32_t k = 0; k < block->span_count; k++)
			if (block->spans[k].end > length ||
			    block->spans[k].start > block->spans[k].end ||
			    block->spans[k].link >= (int)html->link_count)
				abort();
	}
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static struct theme theme;
	struct article_options options = { .theme = &theme, .width_px = 400, .view_px = 300 };
	struct article *article;
	struct html html;

	if (!theme.context && theme_init(&theme, 4, "en") < 0)
		return 0;
	if (html_parse(&html, (struct bytes){ data, size }) == 0) {
		check(&html);
		html_finish(&html);
	}
	/* Shaping is what costs: every eighth input. */
	if (size % 8 == 0 &&
	    article_create(&article, &options, (struct bytes){ data, size }) == 0) {
		if (article_height_px(article) <= 0)
			abort();
		article_link_at(article, 100, 100);
		article_destroy(article);
	}
	return 0;
}
