/* A page's HTML into a flat list of blocks to draw one below the other. libxml2 reads the HTML and
 * forgives; what we do not draw contributes its text, scripts and styles contribute nothing. Only
 * links to parts and their pages ("part:ID", "page:ID") are links. */
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

/* A run of text with the same looks; bytes of the block's text. */
struct html_span {
	uint32_t start, end;
	uint32_t flags; /* of enum html_flag */
	int link;       /* index into links, or -1 */
};

struct html_block {
	enum html_block_kind kind;
	enum text_style style;
	char *text;      /* owned, UTF-8; the picture's name of HTML_IMAGE; NULL of HTML_RULE */
	char *marker;    /* owned; of a list's item: a bullet or its number; else NULL */
	uint32_t indent; /* depth of lists */
	bool quote;      /* inside a blockquote */
	uint32_t row;    /* of a table, counted over the page from 1; 0: in no table */
	uint32_t column, column_count; /* of the cell; its blocks stand one below the other */
	bool heading_cell;
	struct html_span *spans; /* owned, in order, apart */
	uint32_t span_count;
};

struct html {
	struct html_block *blocks; /* owned */
	uint32_t block_count;
	char **links; /* owned: ids of parts */
	uint32_t link_count;
};

enum { HTML_BLOCKS_MAX = 5000, HTML_COLUMNS_MAX = 8, HTML_BYTES_MAX = 256 << 10 };

/* *out is finished by the caller; zeroed on failure. -EBADMSG: not UTF-8, or no text and no picture
 * in it; -EFBIG; -ENOMEM. */
must_check int html_parse(struct html *out, struct bytes source);
/* Adds a paragraph in small below a rule. -ENOMEM, -EFBIG; html is still to be finished then. */
must_check int html_add_note(struct html *html, const char *text);
void html_finish(struct html *html); /* NULL and zeroed are fine */

#endif
