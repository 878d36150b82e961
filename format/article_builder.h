/* Builds an article from texts, pictures and rules in the order in which they are read. White space
 * is joined as HTML joins it: any run of it is one space, and none stands at the begin or end of a
 * block. A paragraph that is too long for a block becomes several.
 *
 * Calls keep the first failure; it is checked once, by article_builder_encode. */
#ifndef GOPURA_FORMAT_ARTICLE_BUILDER_H
#define GOPURA_FORMAT_ARTICLE_BUILDER_H

#include "format/article.h"

/* Appearance and place of what is added; the fields are those of block and span. */
struct article_look {
	enum article_style style;
	uint32_t flags, indent, row, column;
	int link; /* from article_builder_link, or -1 */
	bool quote, heading_cell;
};

struct article_builder {
	/* Arrays of private structs; the texts of blocks; the texts of links. */
	struct buffer blocks, spans, links, text, link_text;
	bool is_open; /* text is appended to the last block */
	/* of a list item whose first block has not been added yet; "": none */
	char marker[ARTICLE_MARKER_BYTES_MAX + 1];
	bool space, space_had_newline; /* white space to be written before the next word */
	/* look of that white space, so that no link begins with a space */
	struct article_look space_in;
};

void article_builder_init(struct article_builder *builder);
void article_builder_finish(struct article_builder *builder); /* frees the memory */

/* Adds a link. Returns its index, or -1 if the id is empty or too long, or after a failure. */
int article_builder_link(struct article_builder *builder, const char *id);
/* Appends text to the open block; opens one if none is open. text is UTF-8 of size bytes. */
void article_builder_text(struct article_builder *builder, const char *text, size_t size,
			  const struct article_look *look);
/* Begins a new line in the open block. */
void article_builder_break(struct article_builder *builder, const struct article_look *look);
/* Ends the open block; what follows stands in another. */
void article_builder_close(struct article_builder *builder);
/* Adds a picture by its name. A name that is empty or too long is left out. */
void article_builder_image(struct article_builder *builder, const char *name,
			   const struct article_look *look);
void article_builder_rule(struct article_builder *builder, const struct article_look *look);
/* Sets the marker of the next block; NULL: it has none. */
void article_builder_marker(struct article_builder *builder, const char *marker);

/* Returns the number of blocks so far. */
uint32_t article_builder_count(const struct article_builder *builder);
/* Says how many columns the row has that the blocks from `first` on are in. */
void article_builder_columns(struct article_builder *builder, uint32_t first, uint32_t columns);
/* Returns the first failure so far: 0, -EFBIG or -ENOMEM. */
int article_builder_error(const struct article_builder *builder);

/* Closes the open block and appends the encoded article to *out. -EBADMSG: there is no block.
 * -EFBIG: more than an article may have. -ENOMEM. */
must_check int article_builder_encode(struct article_builder *builder, struct buffer *out);

#endif
