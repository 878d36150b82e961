/* Any bytes as a page's HTML: compiled as at publishing, and made plain as of an old release. Both
 * give valid articles or none; some are laid out. Drawing is left to the tests of ui, it is slow
 * and sees only what the layout made. */
#include <stdlib.h>

#include "pipeline/content/page_compile.h"
#include "storage/plain_page.h"
#include "ui/article_layout.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void lay_out(struct bytes bytes)
{
	static struct theme theme;
	struct article_layout_options options = { .theme = &theme,
						  .width_px = 400,
						  .view_px = 300 };
	struct article_layout *article;

	if (!theme.context && theme_init(&theme, 4, "en") < 0)
		return;
	if (article_layout_create(&article, &options, bytes) < 0 ||
	    article_layout_height_px(article) <= 0)
		abort();
	article_layout_link_at(article, 100, 100);
	article_layout_destroy(article);
}

static void check(int rc, struct buffer *bytes, bool is_laid_out)
{
	struct article_blocks article;

	if (rc == 0) {
		if (article_decode(&article, buffer_bytes(bytes)) < 0)
			abort();
		article_finish(&article);
		if (is_laid_out)
			lay_out(buffer_bytes(bytes));
	}
	buffer_finish(bytes);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	const bool is_laid_out = size % 8 == 0; /* shaping is what costs */
	const struct bytes html = { data, size };
	struct buffer compiled, plain;

	buffer_init(&compiled, ARTICLE_BYTES_MAX);
	buffer_init(&plain, ARTICLE_BYTES_MAX);
	check(page_compile(&compiled, html), &compiled, is_laid_out);
	check(plain_page(&plain, html), &plain, is_laid_out);
	return 0;
}
