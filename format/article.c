/* Encodes and decodes articles. Decoding counts first, then fills one allocation, and checks all
 * that docs/article.md asks of a valid article. */
#include "format/article.h"

#include <errno.h>
#include <glib.h>
#include <stdlib.h>
#include <string.h>

enum {
	VERSION = 1,
	HEADER_BYTES = 16,
	BLOCK_BYTES = 10,
	SPAN_BYTES = 8,
};

enum block_bit { BIT_QUOTE = 1, BIT_HEADING_CELL = 2, BIT_MARKER = 4, BITS = 7 };

static const char magic[4] = "GPar";

/* ---- encode */

static void put_text(struct buffer *out, const char *text)
{
	if (text)
		buffer_put(out, text, strlen(text) + 1);
}

static void put_block(struct buffer *out, const struct article_block *block)
{
	buffer_put_u8(out, (uint8_t)block->kind);
	buffer_put_u8(out, (uint8_t)block->style);
	buffer_put_u8(out, (uint8_t)((block->quote ? BIT_QUOTE : 0) |
				     (block->heading_cell ? BIT_HEADING_CELL : 0) |
				     (block->marker ? BIT_MARKER : 0)));
	buffer_put_u8(out, (uint8_t)block->indent);
	buffer_put_u16(out, (uint16_t)block->row);
	buffer_put_u8(out, (uint8_t)block->column);
	buffer_put_u8(out, (uint8_t)block->column_count);
	buffer_put_u16(out, (uint16_t)block->span_count);
}

static void put_span(struct buffer *out, const struct article_span *span)
{
	buffer_put_u16(out, (uint16_t)span->start);
	buffer_put_u16(out, (uint16_t)span->end);
	buffer_put_u16(out, (uint16_t)(span->link + 1));
	buffer_put_u16(out, (uint16_t)span->flags);
}

int article_encode(struct buffer *out, const struct article_blocks *article)
{
	uint32_t spans = 0;
	size_t text_bytes = 0;

	for (uint32_t i = 0; i < article->link_count; i++)
		text_bytes += strlen(article->links[i]) + 1;
	for (uint32_t i = 0; i < article->block_count; i++) {
		const struct article_block *block = &article->blocks[i];

		spans += block->span_count;
		text_bytes += block->text ? strlen(block->text) + 1 : 0;
		text_bytes += block->marker ? strlen(block->marker) + 1 : 0;
	}
	buffer_put(out, magic, sizeof(magic));
	buffer_put_u16(out, VERSION);
	buffer_put_u16(out, (uint16_t)article->block_count);
	buffer_put_u16(out, (uint16_t)spans);
	buffer_put_u16(out, (uint16_t)article->link_count);
	buffer_put_u32(out, (uint32_t)text_bytes);
	for (uint32_t i = 0; i < article->block_count; i++)
		put_block(out, &article->blocks[i]);
	for (uint32_t i = 0; i < article->block_count; i++)
		for (uint32_t k = 0; k < article->blocks[i].span_count; k++)
			put_span(out, &article->blocks[i].spans[k]);
	for (uint32_t i = 0; i < article->link_count; i++)
		put_text(out, article->links[i]);
	for (uint32_t i = 0; i < article->block_count; i++) {
		put_text(out, article->blocks[i].text);
		put_text(out, article->blocks[i].marker);
	}
	return out->error;
}

/* ---- decode */

struct decoder {
	struct reader in;           /* stands in the blocks */
	struct reader span_in;      /* stands in the spans */
	const char *text, *end;     /* what is left of the texts, in the article's allocation */
	struct article_span *spans; /* what is left of them, likewise */
	uint32_t span_count;        /* how many are left */
	uint32_t link_count;
};

/* Takes the next text: UTF-8, 1 to bytes_max bytes. NULL: there is none. */
static const char *take_text(struct decoder *d, size_t bytes_max)
{
	const char *text = d->text;
	const char *end = memchr(text, 0, (size_t)(d->end - text));

	if (!end || end == text || (size_t)(end - text) > bytes_max ||
	    !g_utf8_validate(text, end - text, NULL))
		return NULL;
	d->text = end + 1;
	return text;
}

static bool is_between_characters(const char *text, uint32_t at)
{
	return ((unsigned char)text[at] & 0xc0) != 0x80;
}

/* Takes the spans of a block whose text is there. Returns false if they are not valid. */
static bool take_spans(struct decoder *d, struct article_block *block)
{
	const uint32_t text_bytes = block->text ? (uint32_t)strlen(block->text) : 0;
	uint32_t from = 0;

	if (block->span_count > d->span_count ||
	    (block->span_count > 0 && block->kind != ARTICLE_TEXT))
		return false;
	block->spans = d->spans;
	for (uint32_t i = 0; i < block->span_count; i++) {
		struct article_span *span = d->spans++;

		span->start = reader_u16(&d->span_in);
		span->end = reader_u16(&d->span_in);
		span->link = reader_u16(&d->span_in) - 1;
		span->flags = reader_u16(&d->span_in);
		if (span->start < from || span->end <= span->start || span->end > text_bytes ||
		    !is_between_characters(block->text, span->start) ||
		    !is_between_characters(block->text, span->end) ||
		    span->link >= (int)d->link_count || (span->flags & ~(uint32_t)ARTICLE_FLAGS) ||
		    (span->flags == 0 && span->link < 0))
			return false;
		from = span->end;
	}
	d->span_count -= block->span_count;
	return true;
}

/* Returns whether a block's place in tables agrees with that of the block above it (NULL: none). */
static bool is_place_valid(const struct article_block *block, const struct article_block *above)
{
	const uint32_t row_above = above ? above->row : 0;

	if (block->row == 0)
		return block->column == 0 && block->column_count == 0 && !block->heading_cell;
	if (block->column_count > ARTICLE_COLUMNS_MAX || block->column >= block->column_count)
		return false;
	return block->row != row_above ||
	       (block->column >= above->column && block->column_count == above->column_count);
}

/* Returns false if the block is not valid. */
static bool take_block(struct decoder *d, struct article_block *block)
{
	const uint8_t kind = reader_u8(&d->in), style = reader_u8(&d->in), bits = reader_u8(&d->in);

	if (kind > ARTICLE_RULE || style >= ARTICLE_STYLE_COUNT || (bits & ~BITS))
		return false;
	*block = (struct article_block){ .kind = (enum article_kind)kind,
					 .style = (enum article_style)style,
					 .quote = bits & BIT_QUOTE,
					 .heading_cell = bits & BIT_HEADING_CELL };
	block->indent = reader_u8(&d->in);
	block->row = reader_u16(&d->in);
	block->column = reader_u8(&d->in);
	block->column_count = reader_u8(&d->in);
	block->span_count = reader_u16(&d->in);
	if (kind != ARTICLE_RULE && !(block->text = take_text(d, ARTICLE_TEXT_BYTES_MAX)))
		return false;
	if ((bits & BIT_MARKER) && !(block->marker = take_text(d, ARTICLE_MARKER_BYTES_MAX)))
		return false;
	return take_spans(d, block);
}

static int take_all(struct decoder *d, struct article_blocks *article)
{
	uint32_t row_last = 0;

	for (uint32_t i = 0; i < article->link_count; i++) {
		article->links[i] = take_text(d, ARTICLE_TEXT_BYTES_MAX);
		if (!article->links[i])
			return -EBADMSG;
	}
	for (uint32_t i = 0; i < article->block_count; i++) {
		struct article_block *block = &article->blocks[i];
		const struct article_block *above = i > 0 ? block - 1 : NULL;

		if (!take_block(d, block) || !is_place_valid(block, above))
			return -EBADMSG;
		/* A row that was left does not come again. */
		if (block->row && block->row < row_last + !(above && above->row == block->row))
			return -EBADMSG;
		row_last = block->row ? block->row : row_last;
	}
	return d->text == d->end && d->span_count == 0 ? 0 : -EBADMSG;
}

int article_decode(struct article_blocks *out, struct bytes bytes)
{
	struct decoder d = { 0 };
	uint32_t block_count, link_count, text_bytes;
	size_t blocks_room, links_room, spans_room;
	struct bytes head;
	uint8_t *arena;
	int rc;

	*out = (struct article_blocks){ 0 };
	reader_init(&d.in, bytes);
	head = reader_bytes(&d.in, sizeof(magic));
	if (d.in.failed || memcmp(head.data, magic, sizeof(magic)) != 0 ||
	    reader_u16(&d.in) != VERSION)
		return -EBADMSG;
	block_count = reader_u16(&d.in);
	d.span_count = reader_u16(&d.in);
	d.link_count = link_count = reader_u16(&d.in);
	text_bytes = reader_u32(&d.in);
	if (d.in.failed || bytes.size > ARTICLE_BYTES_MAX || block_count == 0 ||
	    block_count > ARTICLE_BLOCKS_MAX ||
	    bytes.size != HEADER_BYTES + (uint64_t)BLOCK_BYTES * block_count +
				  (uint64_t)SPAN_BYTES * d.span_count + text_bytes)
		return -EBADMSG;

	blocks_room = block_count * sizeof(*out->blocks);
	links_room = link_count * sizeof(*out->links);
	spans_room = d.span_count * sizeof(*d.spans);
	arena = malloc(blocks_room + links_room + spans_room + text_bytes);
	if (!arena)
		return -ENOMEM;
	/* In descending order of alignment. */
	*out = (struct article_blocks){ .blocks = (struct article_block *)arena,
					.block_count = block_count,
					.links = (const char **)(arena + blocks_room),
					.link_count = link_count };
	d.spans = (struct article_span *)(arena + blocks_room + links_room);
	d.text = (const char *)arena + blocks_room + links_room + spans_room;
	d.end = d.text + text_bytes;
	memcpy((char *)d.text, bytes.data + bytes.size - text_bytes, text_bytes);
	reader_init(&d.span_in,
		    (struct bytes){ bytes.data + HEADER_BYTES + BLOCK_BYTES * (size_t)block_count,
				    SPAN_BYTES * (size_t)d.span_count });
	rc = take_all(&d, out);
	if (rc < 0)
		article_finish(out);
	return rc;
}

void article_finish(struct article_blocks *article)
{
	if (!article)
		return;
	free(article->blocks);
	*article = (struct article_blocks){ 0 };
}
