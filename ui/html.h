/* Turns a page's HTML into a flat list of blocks that are drawn one below the other. libxml2 parses
 * the HTML and tolerates errors. Elements that we do not draw contribute their text; scripts and
 * styles contribute nothing. Only links to parts, their pages and tours ("part:ID", "page:ID",
 * "tour:ID") are kept. */
#ifndef GOPURA_UI_HTML_H
#define GOPURA_UI_HTML_H

#include "base/bytes.h"
#include "ui/theme.h"

enum html_block_kind { HTML_TEXT, HTML_IMAGE, HTML_RULE };

enum html_flag {
	HTML_EMPHASIS = 1,
	HTML_STRONG = 2,
	HTML_SMALL = 4,
	HTML_SUBSCRIPT = 8,
	HTML_SUPERSCRIPT = 16,
};

/* A run of text with the same appearance. start and end are byte offsets into the block's text. */
struct html_span {
	uint32_t start, end;
	uint32_t flags; /* bits of enum html_flag */
	int link;       /* index into links, or -1 */
};

struct html_block {
	enum html_block_kind kind;
	enum text_style style;
	char *text;      /* owned, UTF-8; the picture's name for HTML_IMAGE; NULL for HTML_RULE */
	char *marker;    /* owned; bullet or number of a list item; otherwise NULL */
	uint32_t indent; /* nesting depth of lists */
	bool quote;      /* inside a blockquote */
	uint32_t row;    /* table row, counted over the whole page from 1; 0: not in a table */
	/* of the cell; a cell's blocks are drawn one below the other */
	uint32_t column, column_count;
	bool heading_cell;
	struct html_span *spans; /* owned, in order, not overlapping */
	uint32_t span_count;
};

struct html {
	struct html_block *blocks; /* owned */
	uint32_t block_count;
	char **links; /* owned: ids of parts, or "tour:" and the id of a tour */
	uint32_t link_count;
};

enum { HTML_BLOCKS_MAX = 5000, HTML_COLUMNS_MAX = 8, HTML_BYTES_MAX = 256 << 10 };

/* source is UTF-8 of at most HTML_BYTES_MAX bytes. The caller finishes *out; it is zeroed on
 * failure. -EBADMSG: not UTF-8, or neither text nor picture in it. -EFBIG: source is too large or
 * gives too many blocks. -ENOMEM. */
must_check int html_parse(struct html *out, struct bytes source);
/* Appends a rule and a paragraph in the style of a caption. -ENOMEM, -EFBIG; html must then still
 * be finished. */
must_check int html_add_note(struct html *html, const char *text);
void html_finish(struct html *html); /* Frees the contents. NULL and zeroed are fine. */

#endif
