/* The table of HTML elements. */
#include "format/html_elements.h"

#include <string.h>
#include <strings.h>

#define INHERITED HTML_STYLE_INHERITED

static const struct html_element elements[] = {
	{ "h1", HTML_BLOCK, ARTICLE_HEADING_1, 0, true, NULL },
	{ "h2", HTML_BLOCK, ARTICLE_HEADING_2, 0, true, NULL },
	{ "h3", HTML_BLOCK, ARTICLE_HEADING_3, 0, true, NULL },
	{ "h4", HTML_BLOCK, ARTICLE_HEADING_3, 0, false, NULL },
	{ "h5", HTML_BLOCK, ARTICLE_HEADING_3, 0, false, NULL },
	{ "h6", HTML_BLOCK, ARTICLE_HEADING_3, 0, false, NULL },
	{ "p", HTML_BLOCK, INHERITED, 0, true, NULL },
	{ "div", HTML_BLOCK, INHERITED, 0, true, NULL },
	{ "section", HTML_BLOCK, INHERITED, 0, true, NULL },
	{ "article", HTML_BLOCK, INHERITED, 0, true, NULL },
	{ "main", HTML_BLOCK, INHERITED, 0, true, NULL },
	{ "header", HTML_BLOCK, INHERITED, 0, true, NULL },
	{ "footer", HTML_BLOCK, INHERITED, 0, true, NULL },
	{ "figure", HTML_BLOCK, ARTICLE_FIGURE, 0, true, NULL },
	{ "figcaption", HTML_BLOCK, ARTICLE_FIGURE, 0, true, NULL },
	{ "blockquote", HTML_QUOTE, ARTICLE_QUOTE, 0, true, NULL },
	{ "ul", HTML_LIST, INHERITED, 0, true, NULL },
	{ "ol", HTML_NUMBERED_LIST, INHERITED, 0, true, NULL },
	{ "li", HTML_ITEM, INHERITED, 0, true, NULL },
	{ "table", HTML_BLOCK, INHERITED, 0, true, NULL },
	{ "caption", HTML_BLOCK, ARTICLE_FIGURE, 0, true, NULL },
	{ "thead", HTML_INLINE, INHERITED, 0, true, NULL },
	{ "tbody", HTML_INLINE, INHERITED, 0, true, NULL },
	{ "tr", HTML_ROW, ARTICLE_CELL, 0, true, NULL },
	{ "td", HTML_CELL, INHERITED, 0, true, NULL },
	{ "th", HTML_HEADING_CELL, INHERITED, 0, true, NULL },
	{ "em", HTML_INLINE, INHERITED, ARTICLE_EMPHASIS, true, NULL },
	{ "i", HTML_INLINE, INHERITED, ARTICLE_EMPHASIS, true, NULL },
	{ "cite", HTML_INLINE, INHERITED, ARTICLE_EMPHASIS, true, NULL },
	{ "dfn", HTML_INLINE, INHERITED, ARTICLE_EMPHASIS, true, NULL },
	{ "strong", HTML_INLINE, INHERITED, ARTICLE_STRONG, true, NULL },
	{ "b", HTML_INLINE, INHERITED, ARTICLE_STRONG, true, NULL },
	{ "small", HTML_INLINE, INHERITED, ARTICLE_SMALL, true, NULL },
	{ "sub", HTML_INLINE, INHERITED, ARTICLE_SUBSCRIPT, true, NULL },
	{ "sup", HTML_INLINE, INHERITED, ARTICLE_SUPERSCRIPT, true, NULL },
	{ "span", HTML_INLINE, INHERITED, 0, true, NULL },
	{ "q", HTML_INLINE, INHERITED, 0, true, NULL },
	{ "abbr", HTML_INLINE, INHERITED, 0, true, NULL },
	{ "time", HTML_INLINE, INHERITED, 0, true, NULL },
	{ "a", HTML_LINK, INHERITED, 0, true, "href" },
	{ "br", HTML_BREAK, INHERITED, 0, true, NULL },
	{ "hr", HTML_RULE, INHERITED, 0, true, NULL },
	{ "img", HTML_IMAGE, INHERITED, 0, true, "src" },
	{ "html", HTML_INLINE, INHERITED, 0, true, NULL },
	{ "body", HTML_INLINE, INHERITED, 0, true, NULL },
	{ "head", HTML_INLINE, INHERITED, 0, true, NULL },
	{ "meta", HTML_INLINE, INHERITED, 0, true, NULL },
	{ "title", HTML_SKIP, INHERITED, 0, true, NULL },
	{ "template", HTML_SKIP, INHERITED, 0, false, NULL },
	{ "script", HTML_RAW, INHERITED, 0, false, NULL },
	{ "style", HTML_RAW, INHERITED, 0, false, NULL },
};

const struct html_element *html_element(const char *name, size_t size)
{
	static const struct html_element unknown = { "", HTML_INLINE, INHERITED, 0, false, NULL };

	for (size_t i = 0; i < ARRAY_COUNT(elements); i++)
		if (strlen(elements[i].name) == size &&
		    strncasecmp(elements[i].name, name, size) == 0)
			return &elements[i];
	return &unknown;
}
