/* The HTML elements of pages, in one table: what they mean for the article that is made of a page,
 * and which of them an author may use. */
#ifndef GOPURA_FORMAT_HTML_ELEMENTS_H
#define GOPURA_FORMAT_HTML_ELEMENTS_H

#include "format/article.h"

enum html_role {
	HTML_INLINE, /* also unknown elements: their text is kept */
	HTML_BLOCK,
	HTML_SKIP, /* contents are dropped */
	HTML_RAW,  /* likewise, and they are not HTML: scripts and styles */
	HTML_BREAK,
	HTML_RULE,
	HTML_IMAGE,
	HTML_LINK,
	HTML_LIST,
	HTML_NUMBERED_LIST,
	HTML_ITEM,
	HTML_QUOTE,
	HTML_ROW,
	HTML_CELL,
	HTML_HEADING_CELL,
};

enum { HTML_STYLE_INHERITED = -1 };

struct html_element {
	const char *name;
	enum html_role role;
	int style;             /* enum article_style, or HTML_STYLE_INHERITED */
	uint32_t flags;        /* bits of enum article_flag */
	bool is_allowed;       /* in pages; docs/information.md */
	const char *attribute; /* the one that is read; NULL: none */
};

/* Returns the element of that name in any case; for an unknown one, an inline element that is not
 * allowed. */
const struct html_element *html_element(const char *name, size_t size);

#endif
