/* Pages for tests of the words: an article made of HTML, as publishing makes it. */
#ifndef GOPURA_TESTS_UI_COMPILED_H
#define GOPURA_TESTS_UI_COMPILED_H

#include <string.h>

#include "format/article.h"
#include "pipeline/content/page_compile.h"
#include "tests/check.h"

/* Borrowed until the next call. */
static inline struct bytes compiled(const char *html)
{
	static struct buffer article;

	buffer_finish(&article);
	buffer_init(&article, ARTICLE_BYTES_MAX);
	CHECK(page_compile(&article, (struct bytes){ (const uint8_t *)html, strlen(html) }) == 0);
	return buffer_bytes(&article);
}

#endif
