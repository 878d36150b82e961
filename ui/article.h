/* A page laid out at a width: how tall it is, what a piece of it looks like, which link lies
 * where. Drawn in pieces, so that a long page needs no long bitmap. Called article because
 * format/page.h has taken the word page. */
#ifndef GOPURA_UI_ARTICLE_H
#define GOPURA_UI_ARTICLE_H

#include "ui/html.h"
#include "ui/source.h"

struct article;

struct article_options {
	const struct theme *theme; /* borrowed */
	int width_px;
	int view_px; /* height of the window on it; no picture is taller than 3/4 of it */
	struct picture_source pictures;
	const char *credits; /* below the page in small; not kept; NULL or "": none */
};

/* html is not kept. *out is owned by the caller; on failure it is NULL. As html_parse. */
must_check int article_create(struct article **out, const struct article_options *options,
			      struct bytes html);
/* In other type, or for another window on it; as article_create. -ENOMEM: it has no links
 * then. */
must_check int article_lay_out(struct article *article, int width_px, int view_px);
void article_destroy(struct article *article); /* NULL is fine */

int article_height_px(const struct article *article);
/* The piece of the article from top_px on, height_px tall, at the origin of context; opaque. */
void article_draw(const struct article *article, cairo_t *context, int top_px, int height_px);
/* The id of the part that a link at or near that point names; NULL: none. Borrowed. */
const char *article_link_at(const struct article *article, float x_px, float y_px);
/* Its pictures, in order; *caption (may be NULL) is what stands below one in its figure, or "".
 * Borrowed. */
uint32_t article_picture_count(const struct article *article);
const char *article_picture(const struct article *article, uint32_t picture, const char **caption);
/* Which picture is there, or -1. */
int article_picture_at(const struct article *article, float x_px, float y_px);
/* Asks the source again and lays out anew. The height from which on something changed, or -1 where
 * the article does not show that picture. */
int article_picture_arrived(struct article *article, const char *name);
/* Glyphs that no installed font has. */
int article_unknown_glyphs(const struct article *article);

#endif
