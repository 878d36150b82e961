/* State of the HTML parser while it builds the blocks. Private to ui/html*.c. */
#ifndef GOPURA_UI_HTML_PARTS_H
#define GOPURA_UI_HTML_PARTS_H

#include "ui/html.h"

/* Properties that a text inherits from the elements around it. Copied on the way down the tree. */
struct html_inherited {
	uint32_t flags, indent, row, column;
	int link;
	int list_number; /* number of the next item of an ol; -1: bullets */
	bool quote, heading_cell;
	enum text_style style;
};

struct html_parser {
	struct html *html;
	struct html_block *open; /* the block that text is appended to; NULL: none */
	size_t open_bytes, open_room;
	/* marker of a list item whose first block has not been added yet */
	const char *marker_wanted;
	char marker[16];
	uint32_t row_count;
	bool space, space_had_newline; /* white space to be written before the next word */
	/* properties at that white space, so that no link begins with a space */
	struct html_inherited space_in;
	/* 0, -ENOMEM or -EFBIG; the first error stops the parser */
	int error;
};

/* Makes room for one more item of item_bytes. Returns the array, perhaps moved. NULL: p->error is
 * set and the array is unchanged. */
void *html_grow(struct html_parser *p, void *array, uint32_t count, size_t item_bytes);
/* Copies text; owned by the caller. NULL: p->error is set. */
char *html_copy(struct html_parser *p, const char *text);

/* Closes the open block: removes trailing spaces and line breaks, and deletes the block if it is
 * empty. */
void html_close_block(struct html_parser *p);
/* Closes the open block and appends another; borrowed until the next one. NULL: p->error is set. */
struct html_block *html_add_block(struct html_parser *p, enum html_block_kind kind,
				  const struct html_inherited *in);
/* Appends a text block and makes it p->open. If that is NULL, p->error is set. */
void html_open_text(struct html_parser *p, const struct html_inherited *in);
/* Appends size bytes of text to the open block. */
void html_append(struct html_parser *p, const char *text, size_t size,
		 const struct html_inherited *in);

#endif
