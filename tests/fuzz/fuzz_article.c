/* Any bytes as an article: refused, or an article that is sound and encodes to the same bytes. */
#include "format/article.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Reads everything that the layout reads. */
static void check(const struct article_blocks *article)
{
	for (uint32_t i = 0; i < article->block_count; i++) {
		const struct article_block *block = &article->blocks[i];
		const size_t length = block->text ? strlen(block->text) : 0;

		if ((block->kind == ARTICLE_RULE) != (block->text == NULL) ||
		    length > ARTICLE_TEXT_BYTES_MAX || (block->marker && !*block->marker) ||
		    (block->row && block->column >= block->column_count))
			abort();
		for (uint32_t k = 0; k < block->span_count; k++)
			if (block->spans[k].end > length ||
			    block->spans[k].start >= block->spans[k].end ||
			    block->spans[k].link >= (int)article->link_count)
				abort();
	}
	for (uint32_t i = 0; i < article->link_count; i++)
		if (!*article->links[i])
			abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct article_blocks article;
	struct buffer again;

	if (article_decode(&article, (struct bytes){ data, size }) < 0)
		return 0;
	check(&article);
	buffer_init(&again, ARTICLE_BYTES_MAX);
	if (article_encode(&again, &article) < 0 || again.size != size ||
	    memcmp(again.data, data, size) != 0)
		abort();
	buffer_finish(&again);
	article_finish(&article);
	return 0;
}
