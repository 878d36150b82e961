/* The blocks of a page while they are made. Private to ui/html*.c. */
#ifndef GOPURA_UI_HTML_PARTS_H
#define GOPURA_UI_HTML_PARTS_H

#include "ui/html.h"

/* What the elements around a text say about it. Copied on the way down. */
struct html_inherited {
	uint32_t flags, indent, row, column;
	int link;
	int list_number; /* of an ol's next item; -1: bullets */
	bool quote, heading_cell;
	enum text_style style;
};

struct html_parser {
	struct html *html;
	struct html_block *open; /* text is being appended; NULL: none */
	size_t open_bytes, open_room;
	const char *marker_wanted; /* of the list item whose first block has not come */
	char marker[16];
	uint32_t row_count;
	bool space, space_had_newline;  /* white space waits for the next word */
	struct html_inherited space_in; /* and looks as what it stood in: no link begins with it */
	int error;
};

/* For one more item, each of item_bytes; NULL: p->error is set, and array is as it was. */
void *html_grow(struct html_parser *p, void *array, uint32_t count, size_t item_bytes);
/* NULL: p->error is set. */
char *html_copy(struct html_parser *p, const char *text);

/* Takes a trailing line break or space off; an empty block goes altogether. */
void html_close_block(struct html_parser *p);
/* Closes the one before. NULL: p->error is set. */
struct html_block *html_add_block(struct html_parser *p, enum html_block_kind kind,
				  const struct html_inherited *in);
/* A block for text, p->open; NULL there: p->error is set. */
void html_open_text(struct html_parser *p, const struct html_inherited *in);
/* To the open block. */
void html_append(struct html_parser *p, const char *text, size_t size,
		 const struct html_inherited *in);

#endif
