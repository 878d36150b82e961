/* Collects blocks, spans and texts in growing buffers, and points the blocks at them when the
 * article is encoded. */
#include "format/article_builder.h"

#include <errno.h>
#include <string.h>

enum { NO_TEXT = UINT32_MAX };

/* A block whose texts and spans are named by their places, since the buffers still move. */
struct draft {
	struct article_block block;  /* pointers not set yet */
	uint32_t text_at, marker_at; /* offsets in text; NO_TEXT: none */
	uint32_t span_at;            /* index of its first span */
};

void article_builder_init(struct article_builder *b)
{
	*b = (struct article_builder){ 0 };
	buffer_init(&b->blocks, ARTICLE_BLOCKS_MAX * sizeof(struct draft));
	buffer_init(&b->spans, ARTICLE_SPANS_MAX * sizeof(struct article_span));
	buffer_init(&b->links, ARTICLE_LINKS_MAX * sizeof(uint32_t));
	buffer_init(&b->text, ARTICLE_BYTES_MAX);
	buffer_init(&b->link_text, ARTICLE_BYTES_MAX);
}

void article_builder_finish(struct article_builder *b)
{
	buffer_finish(&b->blocks);
	buffer_finish(&b->spans);
	buffer_finish(&b->links);
	buffer_finish(&b->text);
	buffer_finish(&b->link_text);
}

int article_builder_error(const struct article_builder *b)
{
	const int errors[] = { b->blocks.error, b->spans.error, b->links.error, b->text.error,
			       b->link_text.error };

	for (size_t i = 0; i < ARRAY_COUNT(errors); i++)
		if (errors[i])
			return errors[i];
	return 0;
}

uint32_t article_builder_count(const struct article_builder *b)
{
	return (uint32_t)(b->blocks.size / sizeof(struct draft));
}

static uint32_t span_count(const struct article_builder *b)
{
	return (uint32_t)(b->spans.size / sizeof(struct article_span));
}

static struct draft *draft_at(const struct article_builder *b, uint32_t i)
{
	return (struct draft *)b->blocks.data + i;
}

static struct draft *last_draft(const struct article_builder *b)
{
	return draft_at(b, article_builder_count(b) - 1);
}

/* Bytes of the open block's text so far. */
static size_t open_bytes(const struct article_builder *b)
{
	return b->text.size - last_draft(b)->text_at;
}

/* ---- blocks */

static uint32_t put_string(struct buffer *text, const char *string)
{
	const uint32_t at = (uint32_t)text->size;

	buffer_put(text, string, strlen(string) + 1);
	return at;
}

/* Spans are in text order, so those of removed text come last. */
static void trim_spans(struct article_builder *b, uint32_t text_bytes)
{
	const uint32_t first = last_draft(b)->span_at;
	struct article_span *spans = (struct article_span *)b->spans.data;
	uint32_t count = span_count(b);

	while (count > first && spans[count - 1].start >= text_bytes)
		count--;
	if (count > first && spans[count - 1].end > text_bytes)
		spans[count - 1].end = text_bytes;
	b->spans.size = count * sizeof(*spans);
}

static bool is_trimmed(char c)
{
	return c == ' ' || c == '\n';
}

void article_builder_close(struct article_builder *b)
{
	b->space = false;
	b->space_had_newline = false;
	if (!b->is_open)
		return;
	b->is_open = false;
	/* A block begins with a word, so something is left. */
	while (open_bytes(b) > 0 && is_trimmed((char)b->text.data[b->text.size - 1]))
		b->text.size--;
	trim_spans(b, (uint32_t)open_bytes(b));
	last_draft(b)->block.span_count = span_count(b) - last_draft(b)->span_at;
	buffer_put_u8(&b->text, 0);
}

/* Closes the open block and appends another. Returns false after a failure. */
static bool add_block(struct article_builder *b, enum article_kind kind,
		      const struct article_look *look)
{
	const uint32_t indent = look->indent;
	struct draft draft = {
		.block = { .kind = kind,
			   .style = look->style,
			   .indent = indent < ARTICLE_INDENT_MAX ? indent : ARTICLE_INDENT_MAX,
			   .quote = look->quote,
			   .row = look->row,
			   .column = look->column,
			   .heading_cell = look->heading_cell },
		.text_at = NO_TEXT,
		.marker_at = NO_TEXT
	};

	article_builder_close(b);
	if (look->row > ARTICLE_ROWS_MAX)
		b->blocks.error = -EFBIG;
	draft.span_at = span_count(b);
	if (b->marker[0])
		draft.marker_at = put_string(&b->text, b->marker);
	b->marker[0] = '\0';
	if (kind != ARTICLE_RULE)
		draft.text_at = (uint32_t)b->text.size;
	buffer_put(&b->blocks, &draft, sizeof(draft));
	return article_builder_error(b) == 0;
}

void article_builder_rule(struct article_builder *b, const struct article_look *look)
{
	add_block(b, ARTICLE_RULE, look);
}

void article_builder_image(struct article_builder *b, const char *name,
			   const struct article_look *look)
{
	if (*name && strlen(name) <= ARTICLE_TEXT_BYTES_MAX && add_block(b, ARTICLE_IMAGE, look))
		put_string(&b->text, name);
}

void article_builder_marker(struct article_builder *b, const char *marker)
{
	const size_t size = marker ? strnlen(marker, ARTICLE_MARKER_BYTES_MAX) : 0;

	memcpy(b->marker, marker ? marker : "", size);
	b->marker[size] = '\0';
}

void article_builder_columns(struct article_builder *b, uint32_t first, uint32_t columns)
{
	for (uint32_t i = first; i < article_builder_count(b); i++)
		draft_at(b, i)->block.column_count = columns;
}

int article_builder_link(struct article_builder *b, const char *id)
{
	const uint32_t at = (uint32_t)b->link_text.size;

	if (!*id || strlen(id) > ARTICLE_TEXT_BYTES_MAX)
		return -1;
	put_string(&b->link_text, id);
	buffer_put(&b->links, &at, sizeof(at));
	return article_builder_error(b) ? -1 : (int)(b->links.size / sizeof(at)) - 1;
}

/* ---- text */

static void mark_span(struct article_builder *b, uint32_t start, uint32_t end,
		      const struct article_look *look)
{
	const uint32_t count = span_count(b);
	struct article_span span = { start, end, look->flags, look->link }, *last = NULL;

	if (look->flags == 0 && look->link < 0)
		return;
	if (count > last_draft(b)->span_at)
		last = (struct article_span *)b->spans.data + count - 1;
	if (last && last->end == start && last->flags == look->flags && last->link == look->link)
		last->end = end;
	else
		buffer_put(&b->spans, &span, sizeof(span));
}

static void append(struct article_builder *b, const char *text, size_t size,
		   const struct article_look *look)
{
	const uint32_t start = (uint32_t)open_bytes(b);

	buffer_put(&b->text, text, size);
	if (b->text.error == 0)
		mark_span(b, start, start + (uint32_t)size, look);
}

void article_builder_break(struct article_builder *b, const struct article_look *look)
{
	if (b->is_open && open_bytes(b) >= ARTICLE_TEXT_BYTES_MAX)
		article_builder_close(b);
	if (b->is_open && article_builder_error(b) == 0)
		append(b, "\n", 1, look);
}

static bool is_space(char c)
{
	return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f';
}

/* Ideographs, kana and their punctuation: three bytes, U+3000 to U+9FFF, or full-width forms in
 * U+F900 to U+FFEF. A line break between two of them in the source is not a space. */
static bool is_wide(const char *text, size_t left)
{
	const unsigned char first = (unsigned char)*text;

	return left >= 3 && ((first >= 0xe3 && first <= 0xe9) || first == 0xef);
}

static void put_space(struct article_builder *b, const char *next, size_t left)
{
	const char *end = (const char *)b->text.data + b->text.size;
	const size_t size = open_bytes(b);
	bool none = size == 0 || end[-1] == '\n' || end[-1] == ' ';

	if (!none && b->space_had_newline && size >= 3 && is_wide(next, left) &&
	    is_wide(end - 3, 3))
		none = true;
	if (!none)
		append(b, " ", 1, &b->space_in);
	b->space = false;
	b->space_had_newline = false;
}

/* Returns the length of the word up to the next white space. A very long word is cut between
 * characters. */
static size_t word_bytes(const char *text, size_t left)
{
	size_t size = 0;

	while (size < left && !is_space(text[size]))
		size++;
	if (size < ARTICLE_TEXT_BYTES_MAX / 2)
		return size;
	size = ARTICLE_TEXT_BYTES_MAX / 2;
	while ((text[size] & 0xc0) == 0x80)
		size--;
	return size;
}

static void put_word(struct article_builder *b, const char *word, size_t size, size_t left,
		     const struct article_look *look)
{
	if (b->is_open && open_bytes(b) + size + 1 > ARTICLE_TEXT_BYTES_MAX)
		article_builder_close(b);
	if (!b->is_open)
		b->is_open = add_block(b, ARTICLE_TEXT, look);
	if (b->is_open && b->space)
		put_space(b, word, left);
	if (b->is_open)
		append(b, word, size, look);
}

void article_builder_text(struct article_builder *b, const char *text, size_t left,
			  const struct article_look *look)
{
	while (left > 0 && article_builder_error(b) == 0) {
		size_t word;

		while (left > 0 && is_space(*text)) {
			if (!b->space)
				b->space_in = *look;
			b->space = true;
			b->space_had_newline |= *text == '\n';
			text++;
			left--;
		}
		word = word_bytes(text, left);
		if (word == 0)
			break;
		put_word(b, text, word, left, look);
		text += word;
		left -= word;
	}
}

/* ---- encode */

static const char *string_at(const struct buffer *text, uint32_t at)
{
	return at == NO_TEXT ? NULL : (const char *)text->data + at;
}

/* Points blocks at their texts and spans, and links at theirs. The arrays are as long as the
 * builder has blocks and links. */
static void resolve(const struct article_builder *b, struct article_blocks *article)
{
	for (uint32_t i = 0; i < article->block_count; i++) {
		const struct draft *draft = draft_at(b, i);
		struct article_block *block = &article->blocks[i];

		*block = draft->block;
		block->text = string_at(&b->text, draft->text_at);
		block->marker = string_at(&b->text, draft->marker_at);
		if (block->span_count > 0)
			block->spans = (const struct article_span *)b->spans.data + draft->span_at;
	}
	for (uint32_t i = 0; i < article->link_count; i++)
		article->links[i] = string_at(&b->link_text, ((const uint32_t *)b->links.data)[i]);
}

int article_builder_encode(struct article_builder *b, struct buffer *out)
{
	struct article_blocks article = { 0 };
	struct buffer blocks, links;
	int rc;

	article_builder_close(b);
	rc = article_builder_error(b);
	if (rc < 0)
		return rc;
	article.block_count = article_builder_count(b);
	article.link_count = (uint32_t)(b->links.size / sizeof(uint32_t));
	if (article.block_count == 0)
		return -EBADMSG;
	buffer_init(&blocks, ARTICLE_BLOCKS_MAX * sizeof(*article.blocks));
	buffer_init(&links, ARTICLE_LINKS_MAX * sizeof(*article.links));
	article.blocks =
		(void *)buffer_extend(&blocks, article.block_count * sizeof(*article.blocks));
	article.links = (void *)buffer_extend(&links, article.link_count * sizeof(*article.links));
	if (article.blocks && (article.links || article.link_count == 0)) {
		resolve(b, &article);
		rc = article_encode(out, &article);
	} else {
		rc = -ENOMEM;
	}
	buffer_finish(&blocks);
	buffer_finish(&links);
	return rc;
}
