/* An article: a part's page as a list of blocks that are drawn one below the other. It is made from
 * the author's HTML at publishing; docs/article.md describes the bytes. */
#ifndef GOPURA_FORMAT_ARTICLE_H
#define GOPURA_FORMAT_ARTICLE_H

#include "base/bytes.h"

enum article_kind { ARTICLE_TEXT, ARTICLE_IMAGE, ARTICLE_RULE };

enum article_style {
	ARTICLE_BODY,
	ARTICLE_HEADING_1,
	ARTICLE_HEADING_2,
	ARTICLE_HEADING_3,
	ARTICLE_QUOTE,
	ARTICLE_FIGURE, /* under a picture */
	ARTICLE_CELL,   /* in a table */
	ARTICLE_STYLE_COUNT,
};

enum article_flag {
	ARTICLE_EMPHASIS = 1,
	ARTICLE_STRONG = 2,
	ARTICLE_SMALL = 4,
	ARTICLE_SUBSCRIPT = 8,
	ARTICLE_SUPERSCRIPT = 16,
	ARTICLE_FLAGS = 31, /* all of them */
};

/* A run of text with the same appearance. start and end are byte offsets into the block's text. */
struct article_span {
	uint32_t start, end;
	uint32_t flags; /* bits of enum article_flag */
	int link;       /* index into links, or -1 */
};

struct article_block {
	enum article_kind kind;
	enum article_style style;
	const char *text;   /* UTF-8; the picture's name for ARTICLE_IMAGE; NULL for ARTICLE_RULE */
	const char *marker; /* bullet or number of a list item; otherwise NULL */
	uint32_t indent;    /* nesting depth of lists */
	bool quote;         /* inside a blockquote */
	uint32_t row;       /* table row, counted over the whole page from 1; 0: not in a table */
	/* of the cell; a cell's blocks are drawn one below the other */
	uint32_t column, column_count;
	bool heading_cell;
	const struct article_span *spans; /* in order, not overlapping */
	uint32_t span_count;
};

struct article_blocks {
	struct article_block *blocks; /* this and all they point to: one allocation, if decoded */
	uint32_t block_count;
	const char **links; /* ids of parts, or "tour:" and the id of a tour */
	uint32_t link_count;
};

enum {
	ARTICLE_BYTES_MAX = 1 << 20, /* encoded */
	ARTICLE_BLOCKS_MAX = 5000,
	ARTICLE_SPANS_MAX = 65535,
	ARTICLE_LINKS_MAX = 65535,
	ARTICLE_COLUMNS_MAX = 8,
	ARTICLE_ROWS_MAX = 65535,
	ARTICLE_INDENT_MAX = 255,
	/* The layout breaks lines one paragraph at a time, and its cost grows faster than the
	 * paragraph: 256 KiB without a space took 20 s. So a block holds at most a few book pages
	 * of text. */
	ARTICLE_TEXT_BYTES_MAX = 8192,
	ARTICLE_MARKER_BYTES_MAX = 15,
};

/* Appends the article to *out. It must be valid as docs/article.md says. Returns the error of *out:
 * 0, -EFBIG or -ENOMEM. */
must_check int article_encode(struct buffer *out, const struct article_blocks *article);
/* The bytes are not kept. The caller finishes *out; it is zeroed on failure. -EBADMSG: not a valid
 * article. -ENOMEM. */
must_check int article_decode(struct article_blocks *out, struct bytes bytes);
/* Frees a decoded article. NULL and zeroed are fine. */
void article_finish(struct article_blocks *article);

#endif
