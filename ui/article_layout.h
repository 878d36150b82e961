/* An article (format/article.h) laid out for a given width: its height, its appearance piece by
 * piece, and the places of its links. It is drawn in pieces, so that a long page needs no long
 * bitmap. */
#ifndef GOPURA_UI_ARTICLE_LAYOUT_H
#define GOPURA_UI_ARTICLE_LAYOUT_H

#include "format/article.h"
#include "ui/source.h"
#include "ui/theme.h"

struct article_layout;

struct article_layout_options {
	const struct theme *theme; /* borrowed */
	int width_px;
	int view_px; /* height of the visible window; no picture is taller than 3/4 of it */
	struct picture_source pictures;
	const char
		*credits; /* small print below the page; read during the call; NULL or "": none */
};

/* Decodes an article and lays it out; the bytes are not kept. *out is owned by the caller; on
 * failure it is NULL. Returns the errors of article_decode. */
must_check int article_layout_create(struct article_layout **out,
				     const struct article_layout_options *options,
				     struct bytes bytes);
/* Lays out again, for another type size or another window. Returns -ENOMEM; the article then has no
 * links. */
must_check int article_layout_resize(struct article_layout *article, int width_px, int view_px);
void article_layout_destroy(struct article_layout *article); /* NULL is fine */

/* Returns the height of the whole article. */
int article_layout_height_px(const struct article_layout *article);
/* Draws the piece of the article from top_px on, height_px tall, at the origin of context. The
 * piece is opaque. */
void article_layout_draw(const struct article_layout *article, cairo_t *context, int top_px,
			 int height_px);
/* Returns what the link at or near that point names (the id of a part, or "tour:" and a tour's id),
 * or NULL. Coordinates are the article's. Borrowed until the article is destroyed. */
const char *article_layout_link_at(const struct article_layout *article, float x_px, float y_px);
/* The pictures in order. article_layout_picture() returns the name of one; *caption (may be NULL)
 * is set to its caption, or "". Both are borrowed. */
uint32_t article_layout_picture_count(const struct article_layout *article);
/* See above. */
const char *article_layout_picture(const struct article_layout *article, uint32_t picture,
				   const char **caption);
/* Returns the number of the picture at that point, or -1. */
int article_layout_picture_at(const struct article_layout *article, float x_px, float y_px);
/* Asks the picture source again and lays out anew. Returns the height from which on the article
 * changed, or -1 if it does not show that picture. */
int article_layout_picture_arrived(struct article_layout *article, const char *name);
/* Returns how many glyphs no installed font has. */
int article_layout_unknown_glyphs(const struct article_layout *article);

#endif
