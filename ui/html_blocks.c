/* Builds the list of blocks: opens and closes them, appends text, and records spans of equal
 * appearance. */
#include "ui/html_parts.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

void *html_grow(struct html_parser *p, void *array, uint32_t count, size_t item_bytes)
{
	void *grown = array;

	if ((count & (count - 1)) == 0)
		grown = realloc(array, (count ? 2 * (size_t)count : 1) * item_bytes);
	if (!grown)
		p->error = -ENOMEM;
	return grown;
}

char *html_copy(struct html_parser *p, const char *text)
{
	char *made = strdup(text);

	if (!made)
		p->error = -ENOMEM;
	return made;
}

/* Spans are in text order, so those of removed text come last. */
static void trim_spans(struct html_block *block, uint32_t size)
{
	while (block->span_count > 0 && block->spans[block->span_count - 1].start >= size)
		block->span_count--;
	if (block->span_count > 0 && block->spans[block->span_count - 1].end > size)
		block->spans[block->span_count - 1].end = size;
}

void html_close_block(struct html_parser *p)
{
	struct html_block *block = p->open;

	p->open = NULL;
	p->space = false;
	p->space_had_newline = false;
	if (!block)
		return;
	while (p->open_bytes > 0 && strchr("\n ", block->text[p->open_bytes - 1]))
		block->text[--p->open_bytes] = 0;
	trim_spans(block, (uint32_t)p->open_bytes);
	if (p->open_bytes == 0) {
		free(block->text);
		free(block->marker);
		free(block->spans);
		p->html->block_count--;
	}
}

struct html_block *html_add_block(struct html_parser *p, enum html_block_kind kind,
				  const struct html_inherited *in)
{
	struct html *html = p->html;
	struct html_block *grown, *block;

	html_close_block(p);
	if (p->error == 0 && html->block_count == HTML_BLOCKS_MAX)
		p->error = -EFBIG;
	if (p->error)
		return NULL;
	grown = html_grow(p, html->blocks, html->block_count, sizeof(*grown));
	if (!grown)
		return NULL;
	html->blocks = grown;
	block = &grown[html->block_count++];
	*block = (struct html_block){ .kind = kind,
				      .style = in->style,
				      .indent = in->indent,
				      .quote = in->quote,
				      .row = in->row,
				      .column = in->column,
				      .heading_cell = in->heading_cell };
	if (p->marker_wanted) {
		block->marker = html_copy(p, p->marker_wanted);
		p->marker_wanted = NULL;
	}
	return block;
}

void html_open_text(struct html_parser *p, const struct html_inherited *in)
{
	p->open = html_add_block(p, HTML_TEXT, in);
	if (!p->open)
		return;
	p->open_bytes = 0;
	p->open_room = 64;
	p->open->text = calloc(1, p->open_room);
	if (!p->open->text) {
		p->error = -ENOMEM;
		p->open = NULL;
		p->html->block_count--;
	}
}

static void mark_span(struct html_parser *p, uint32_t start, uint32_t end,
		      const struct html_inherited *in)
{
	struct html_block *block = p->open;
	struct html_span *last = block->span_count ? &block->spans[block->span_count - 1] : NULL;
	struct html_span *grown;

	if (in->flags == 0 && in->link < 0)
		return;
	if (last && last->end == start && last->flags == in->flags && last->link == in->link) {
		last->end = end;
		return;
	}
	grown = html_grow(p, block->spans, block->span_count, sizeof(*grown));
	if (!grown)
		return;
	block->spans = grown;
	grown[block->span_count++] = (struct html_span){ start, end, in->flags, in->link };
}

void html_append(struct html_parser *p, const char *text, size_t size,
		 const struct html_inherited *in)
{
	uint32_t start = (uint32_t)p->open_bytes;

	if (p->error)
		return;
	if (p->open_bytes + size + 1 > p->open_room) {
		size_t room = 2 * (p->open_bytes + size + 1);
		char *grown = realloc(p->open->text, room);

		if (!grown) {
			p->error = -ENOMEM;
			return;
		}
		p->open->text = grown;
		p->open_room = room;
	}
	memcpy(p->open->text + p->open_bytes, text, size);
	p->open_bytes += size;
	p->open->text[p->open_bytes] = 0;
	mark_span(p, start, (uint32_t)p->open_bytes, in);
}
